// SPDX-License-Identifier: Apache-2.0
// Interpolation of a measured reflectance between its wavelengths.
#pragma once

#include <array>
#include <span>
#include <vector>

namespace aureole::pigment {

/// Widest gap between wavelengths that cubics bridge [nm]; wider gaps are bridged by straight lines.
inline constexpr double kWidestCubicStep = 20.5;

/// A value between measured wavelengths: the sum of weight[j] times the value at the wavelength first + j.
struct InterpolationWeights {
  std::size_t first = 0, count = 0;
  std::array<double, 4> weight{};
};

/// The cubic through the four nearest wavelengths (Lagrange, as in ASTM E2022), or a straight line where they are more
/// than 20 nm apart or fewer than four. Beyond the wavelengths the value is constant. `nm` increases and has at least
/// two wavelengths.
InterpolationWeights interpolation_weights(std::span<const double> nm, double wavelength);

/// A reflectance, with one value for each of `nm`, at other wavelengths.
std::vector<double> interpolated(std::span<const double> nm, std::span<const double> values,
                                 std::span<const double> wavelengths);

}  // namespace aureole::pigment
