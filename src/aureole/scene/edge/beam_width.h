// SPDX-License-Identifier: Apache-2.0
// `BeamWidth`: the width of the beams in the diffraction model `beams`; and the settings of diffraction.
#pragma once

#include <string>

#include "aureole/core/error.h"

namespace aureole {

/// The standard deviation of the intensity across a beam, over which light counts as coherent: a number of
/// wavelengths, a length, or the root of wavelength times a distance.
struct BeamWidth {
  enum class Unit { wavelengths, length, fresnel };
  Unit unit = Unit::wavelengths;
  double value = 25;  ///< a number, or metres

  bool operator==(const BeamWidth&) const = default;

  /// Returns the width in metres.
  double at(double wavelength_m) const;
  /// Whether the width is one number of wavelengths at all wavelengths, so that diffracted directions do not
  /// depend on the wavelength.
  bool is_achromatic() const { return unit == Unit::wavelengths; }

  /// Reads "25" or "25 wavelengths", "3mm", "fresnel 10m". Throws Error.
  static BeamWidth parse(const std::string& text);
};

/// How edges diffract light (docs/diffraction.md).
struct DiffractionSettings {
  enum class Model {
    beams,    ///< edges are scatterers of light in beams
    segments  ///< each segment has a diffraction factor |u/u0|^2 by the edges beside it
  };
  Model model = Model::segments;
  BeamWidth width{};  ///< of the model `beams`
  /// The polarisation in the model `segments`: the direction of the field at each edge.
  enum class Polarisation {
    none,  ///< edges act as those of half planes that absorb
    soft,  ///< the electric field lies along each edge
    hard,  ///< the magnetic field lies along each edge
    both   ///< the mean power of soft and hard
  };
  Polarisation polarisation = Polarisation::none;

  bool operator==(const DiffractionSettings&) const = default;
};

/// The width of beams does not suit the scene.
class BeamWidthError : public Error {
public:
  using Error::Error;
};

}  // namespace aureole
