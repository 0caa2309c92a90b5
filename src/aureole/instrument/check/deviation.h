// SPDX-License-Identifier: Apache-2.0
// Comparisons of numbers that should be equal, and messages about differences.
#pragma once

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "aureole/math/vec.h"
#include "aureole/spectrum/spectrum.h"

namespace aureole::check {

/// Relative difference of a and b beyond an absolute tolerance, relative to the larger one; NaN if one is
/// NaN.
inline double deviation(double a, double b, double absolute) {
  const double beyond = std::abs(a - b) - absolute;
  return beyond <= 0 ? 0 : beyond / std::max(std::abs(a), std::abs(b));
}
/// Whether deviation a is worse than b; NaN is the worst.
inline bool is_worse(double a, double b) { return !std::isnan(b) && !(a <= b); }
inline bool are_close(double a, double b, double relative, double absolute) {
  return deviation(a, b, absolute) <= relative;
}

/// Returns the first component that is negative, infinite or NaN, or else component 0.
inline float invalid_in(const Spectrum& s) {
  for (int j = 0; j < kWavelengths; ++j)
    if (!(s[j] >= 0 && std::isfinite(s[j]))) return s[j];
  return s[0];
}

inline std::string to_text(const Vec3& v) {
  std::ostringstream text;
  text << "(" << v.x << ", " << v.y << ", " << v.z << ")";
  return text.str();
}
/// Concatenates texts and numbers.
template <class... Parts>
std::string sentence(const Parts&... parts) {
  std::ostringstream text;
  text.precision(8);
  (text << ... << parts);
  return text.str();
}

}  // namespace aureole::check
