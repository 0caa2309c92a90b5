// SPDX-License-Identifier: Apache-2.0
// Work without Python's lock that may still run when the program ends.
#pragma once

#include <nanobind/nanobind.h>

#include <chrono>
#include <functional>

#include "aureole/core/error.h"

namespace aureole::python {

namespace nb = nanobind;

/// Python's lock is released for a scope.
///
/// As nb::gil_scoped_release, but for daemon threads at the end of the program: Python ends a thread that
/// asks for the lock then by unwinding it (before 3.14), which aborts the process in C++. Such a thread stays
/// in the destructor, or the constructor, instead until the process is gone.
class Unlocked {
public:
  /// `before_staying` ends work of other threads that the scope's owner has begun: nobody else would.
  explicit Unlocked(std::function<void()> before_staying = {});
  ~Unlocked();
  Unlocked(const Unlocked&) = delete;
  Unlocked& operator=(const Unlocked&) = delete;

private:
  [[noreturn]] void stay();
  std::function<void()> before_staying_;
  PyThreadState* state_;
};

/// Work of other threads that may call Python: the end of the program waits for it as for an `Unlocked` scope.
class Unfinished {
public:
  Unfinished();
  ~Unfinished();
  Unfinished(const Unfinished&) = delete;
  Unfinished& operator=(const Unfinished&) = delete;
};

/// Whether the program is ending, so that loops of other threads must stop. Not within a `Callback`.
bool is_leaving();

/// Python's lock, held by work that calls what a program gave it, such as a BSDF written in Python. What that calls of
/// this module must come back even where the program ends: the work, for which `leave` waits, cannot stop within it.
class Callback {
public:
  Callback();
  ~Callback();
  Callback(const Callback&) = delete;
  Callback& operator=(const Callback&) = delete;

private:
  nb::gil_scoped_acquire lock_;
};

/// To be called now and then by loops that have released the interpreter's lock.
class SignalCheck {
public:
  /// True where a signal's handler has raised an exception, which `rethrow` throws, or the program ends.
  bool raised() {
    const auto now = std::chrono::steady_clock::now();
    if (raised_ || now - last_ < std::chrono::milliseconds(50)) return raised_;
    last_ = now;
    if (is_leaving()) return raised_ = true;
    const nb::gil_scoped_acquire lock;
    return raised_ = PyErr_CheckSignals() != 0;
  }
  void rethrow() const {
    if (!raised_) return;
    if (is_leaving()) throw Error("the program ends");  // seen by nobody: the thread stays in ~Unlocked
    const nb::gil_scoped_acquire lock;
    throw nb::python_error();
  }
  void operator()() {
    if (raised()) rethrow();
  }

private:
  bool raised_ = false;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// Makes the end of the program wait, for a limited time, until no thread is in an `Unlocked` scope and nothing is `Unfinished`.
void bind_leaving();

}  // namespace aureole::python
