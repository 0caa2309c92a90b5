// SPDX-License-Identifier: Apache-2.0
// The colour of a measured reflectance for an observer under an illuminant.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "aureole/pigment/colour_difference.h"

namespace aureole::pigment {

/// An illuminant and an observer, as weights of a reflectance given at certain wavelengths. Between them the
/// reflectance is the cubic through the four nearest ones (Lagrange, as in ASTM E2022), or linear where they are more
/// than 20 nm apart; beyond them it is constant.
class Observation {
public:
  /// `lamp` is the spectral power of the illuminant, in any unit, and `observer` is x-bar, y-bar, z-bar, as
  /// functions of the wavelength in nm. They are summed every nanometre from 360 to 830 nm (CIE 15:2018,
  /// 7.1). Throws std::domain_error if `nm` does not increase or if more than 2 % of the illuminant's
  /// luminance is outside its range.
  Observation(std::string name, std::span<const double> nm, const std::function<double(double)>& lamp,
              const std::array<std::function<double(double)>, 3>& observer);

  const std::string& name() const { return name_; }
  /// The weights of means over `group` neighbouring wavelengths each, for quick estimates.
  Observation grouped(std::size_t group) const;
  /// Tristimulus values of a reflectance at the wavelengths; a perfect diffuser has Y = 1.
  Xyz xyz(std::span<const double> reflectance) const;
  const Xyz& white() const { return white_; }
  /// The weights of the reflectance at each wavelength in X, Y and Z.
  const std::vector<Xyz>& weights() const { return weights_; }
  Lab lab(std::span<const double> reflectance) const { return lab_of_xyz(xyz(reflectance), white_); }

private:
  std::string name_;
  std::vector<Xyz> weights_;
  Xyz white_{};
};

}  // namespace aureole::pigment
