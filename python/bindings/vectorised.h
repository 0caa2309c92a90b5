// SPDX-License-Identifier: Apache-2.0
// Loops over whole arrays: on all cores, without the interpreter's lock, and such that Ctrl-C ends them.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <complex>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <thread>

#include "aureole/core/error.h"
#include "aureole/core/parallel.h"
#include "unlocked.h"

namespace aureole::python {

namespace nb = nanobind;
using Complex = std::complex<double>;

/// Arrays as the package's Python files hand them over: flat, contiguous, results allocated by the caller.
/// Results need `.noconvert()`, or a copy would be filled.
template <class T, int kDimensions = 1>
using Array = nb::ndarray<T, nb::ndim<kDimensions>, nb::c_contig, nb::device::cpu>;
using Reals = Array<const double>;
using Complexes = Array<const Complex>;

inline void require_size(bool right, const char* function) {
  if (!right) throw Error(std::string(function) + ": the arrays have sizes that do not fit");
}

/// Calls f and turns the library's std::domain_error into an Error that names the argument `name`.
template <class F>
auto naming(const std::string& name, const F& f) {
  try {
    return f();
  } catch (const std::domain_error& e) {
    throw Error(name + ": " + e.what());
  }
}

/// Calls body(i) for i in [0, n). The calls must not depend on one another. `signals` is shared by loops that
/// follow one another, each of which may be too short to look.
template <class Body>
void for_each(std::size_t n, const Body& body, SignalCheck& signals) {
  using Clock = std::chrono::steady_clock;
  const Unlocked release;
  // Short loops are over before threads would have started.
  const auto start = Clock::now();
  std::size_t done = 0;
  while (done < n) {
    body(done++);
    if ((done < 16 || done % 16 == 0) && Clock::now() - start > std::chrono::milliseconds(1)) break;
  }
  signals();
  if (done == n) return;
  const std::size_t grain = std::clamp<std::size_t>(done / 4, 1, 256);
  const auto caller = std::this_thread::get_id();
  std::atomic<std::size_t> next{done};
  std::atomic<bool> stop{false};
  const std::size_t most = (n - done + grain - 1) / grain;
  run_workers(int(std::min<std::size_t>(std::size_t(default_thread_count()), most)), [&](int) {
    // Signals are handled by the thread that called, the only one that may.
    const bool handles_signals = std::this_thread::get_id() == caller;
    while (!stop) {
      const std::size_t begin = next.fetch_add(grain);
      if (begin >= n) return;
      try {
        for (std::size_t i = begin; i < std::min(n, begin + grain); ++i) body(i);
      } catch (...) {
        stop = true;
        throw;
      }
      if (handles_signals && signals.raised()) stop = true;
    }
  });
  signals.rethrow();
}
template <class Body>
void for_each(std::size_t n, const Body& body) {
  SignalCheck signals;
  for_each(n, body, signals);
}

/// Sets to[i] = f(from[i]). Errors begin with `name`.
template <class F>
void map_numbers(const char* name, const Reals& from, const Array<double>& to, const F& f) {
  require_size(to.size() == from.size(), name);
  naming(name, [&] { for_each(from.size(), [&](std::size_t i) { to.data()[i] = f(from.data()[i]); }); });
}

/// Sets to[i] = f(a[i], b[i]). Errors begin with `name`.
template <class F>
void map_pairs(const char* name, const Reals& a, const Reals& b, const Array<double>& to, const F& f) {
  require_size(a.size() == to.size() && b.size() == to.size(), name);
  naming(name,
         [&] { for_each(to.size(), [&](std::size_t i) { to.data()[i] = f(a.data()[i], b.data()[i]); }); });
}

}  // namespace aureole::python
