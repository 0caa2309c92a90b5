// SPDX-License-Identifier: Apache-2.0
// Colour strength of a colorant by K/S, and the colour difference that remains at equal strength.
#pragma once

#include <span>
#include <vector>

#include "aureole/pigment/observation.h"
#include "aureole/pigment/saunderson.h"

namespace aureole::pigment {

/// Strength of a sample relative to a standard: the ratio of the K/S that the colorants add to the K/S of the
/// white or of the undyed base.
struct ColourStrength {
  /// ratio at the wavelength of the standard's strongest absorption (ISO 787-24, DIN 55603)
  double at_maximum = 0;
  double nm = 0;      ///< wavelength of the standard's strongest absorption
  double summed = 0;  ///< ratio of the sums of K/S over wavelengths from 400 to 700 nm
  /// ratio of the sums of K/S weighted by x-bar + y-bar + z-bar and the illuminant ("apparent strength")
  double weighted = 0;
};

/// Settings by which K/S follows from measured reflectances.
struct StrengthSettings {
  Surface surface = {};  ///< interface between the samples and air
  /// Measured reflectance of the white without colorant; empty: its K/S counts as 0.
  std::vector<double> white = {};
};

/// Colour strength from measured reflectances, which have one value for each wavelength `nm` of `lamp`.
/// Throws std::domain_error if a reflectance is impossible under the interface, or if the standard absorbs no
/// more than the white.
ColourStrength colour_strength(std::span<const double> nm, std::span<const double> standard,
                               std::span<const double> sample, const Observation& lamp,
                               const StrengthSettings& settings = {});

/// The sample's reflectance at the standard's strength: the K/S that its colorant adds is divided by
/// `strength`. The remaining difference from the standard is the difference in tint tone (ISO 787-25).
std::vector<double> at_equal_strength(std::span<const double> nm, std::span<const double> sample,
                                      double strength, const StrengthSettings& settings = {});

}  // namespace aureole::pigment
