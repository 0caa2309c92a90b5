// SPDX-License-Identifier: Apache-2.0
// Double-precision constants used in most of the optics.
#pragma once

#include <complex>
#include <numbers>

namespace aureole::optics {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kDegree = kPi / 180;  ///< one degree [rad]

using Complex = std::complex<double>;

}  // namespace aureole::optics
