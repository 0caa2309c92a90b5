// SPDX-License-Identifier: Apache-2.0
// Work without Python's lock, which has to end well where the program ends meanwhile.
#pragma once

#include <nanobind/nanobind.h>

namespace aureole::python {

namespace nb = nanobind;

/// Python's lock is released for a scope.
///
/// As nb::gil_scoped_release, but for daemon threads at the end of the program: Python ends a thread that
/// asks for the lock then by unwinding it (before 3.14), which aborts the process in C++. Such a thread stays
/// in the destructor instead until the process is gone.
class Unlocked {
public:
  Unlocked();
  ~Unlocked();
  Unlocked(const Unlocked&) = delete;
  Unlocked& operator=(const Unlocked&) = delete;

private:
  PyThreadState* state_;
};

/// The program ends, and what the calling thread does is not wanted any more: loops are to stop.
bool is_leaving();

/// Makes the end of the program wait, for a while, until no thread is in an `Unlocked` scope.
void bind_leaving();

}  // namespace aureole::python
