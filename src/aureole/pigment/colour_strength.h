// SPDX-License-Identifier: Apache-2.0
// Colour strength of a colorant by K/S, and the colour difference that remains at equal strength.
#pragma once

#include <span>
#include <vector>

#include "aureole/pigment/observation.h"
#include "aureole/pigment/saunderson.h"

namespace aureole::pigment {

/// Strength of a sample relative to a standard: the ratio of what the colorants add to the K/S of the white or of the
/// undyed base.
struct ColourStrength {
  double at_maximum =
      0;              ///< at the wavelength of the standard's strongest absorption (ISO 787-24, DIN 55603)
  double nm = 0;      ///< this wavelength
  double summed = 0;  ///< sums of K/S over wavelengths from 400 to 700 nm
  double weighted =
      0;  ///< sums of K/S weighted by x-bar + y-bar + z-bar and the illuminant ("apparent strength")
};

/// How K/S follows from measured reflectances.
struct StrengthSettings {
  Surface surface = {};  ///< interface between the samples and air
  /// Measured reflectance of the white without colorant; empty: its K/S counts as 0.
  std::vector<double> white = {};
};

/// `nm` are the wavelengths of `lamp`, from which all reflectances have one value each. Throws std::domain_error if a
/// reflectance is impossible under the interface, or if the standard absorbs no more than the white.
ColourStrength colour_strength(std::span<const double> nm, std::span<const double> standard,
                               std::span<const double> sample, const Observation& lamp,
                               const StrengthSettings& settings = {});

/// The sample's reflectance at the standard's strength: what its colorant adds to K/S is divided by `strength`. The
/// remaining difference from the standard is that of the tint tone (ISO 787-25).
std::vector<double> at_equal_strength(std::span<const double> nm, std::span<const double> sample,
                                      double strength, const StrengthSettings& settings = {});

}  // namespace aureole::pigment
