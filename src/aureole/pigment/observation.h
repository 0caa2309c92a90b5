// SPDX-License-Identifier: Apache-2.0
// The colour of a measured reflectance for an observer under a lamp.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "aureole/pigment/colour_difference.h"

namespace aureole::pigment {

/// A lamp and an observer, as weights of a reflectance given at certain wavelengths. Between them it is taken
/// to be straight, beyond them to keep its value.
class Observation {
public:
  /// Spectral power of the lamp, in any unit, and the observer's x-bar, y-bar, z-bar, as functions of the
  /// wavelength in nm. They are summed every nanometre from 360 to 830 nm (CIE 15:2018, 7.1). Throws
  /// std::domain_error where `nm` does not increase or leaves more than 2 % of the lamp's luminance outside
  /// of its range.
  Observation(std::string name, std::span<const double> nm, const std::function<double(double)>& lamp,
              const std::array<std::function<double(double)>, 3>& observer);

  const std::string& name() const { return name_; }
  /// Tristimulus values of a reflectance at the wavelengths; a perfect diffuser has Y = 1.
  Xyz xyz(std::span<const double> reflectance) const;
  const Xyz& white() const { return white_; }
  Lab lab(std::span<const double> reflectance) const { return lab_of_xyz(xyz(reflectance), white_); }

private:
  std::string name_;
  std::vector<Xyz> weights_;
  Xyz white_{};
};

}  // namespace aureole::pigment
