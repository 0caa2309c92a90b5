// SPDX-License-Identifier: Apache-2.0
// How much a statistical test computes: `make test` takes as many samples as a real fault needs to be seen,
// AUREOLE_THOROUGH=1 as many as the numbers in docs/ were measured with, and a build with sanitizers runs the
// code without judging statistics.
#pragma once

#include <cstdlib>

namespace aureole::test {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

/// AUREOLE_THOROUGH=1: many more samples, and results are printed.
inline bool is_thorough() { return std::getenv("AUREOLE_THOROUGH") != nullptr; }

/// A number of samples, paths or repetitions.
template <typename T>
T effort(T usual, T thorough) {
  return is_thorough() ? thorough : usual;
}

}  // namespace aureole::test
