// SPDX-License-Identifier: Apache-2.0
// `BeamWidth`: how wide the beams of light are that edges diffract; and the settings of diffraction.
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

  /// In metres.
  double at(double wavelength_m) const;
  /// The same number of wavelengths at all wavelengths, so that diffracted directions are the same for all.
  bool is_achromatic() const { return unit == Unit::wavelengths; }

  /// "25" or "25 wavelengths", "3mm", "fresnel 10m". Throws Error.
  static BeamWidth parse(const std::string& text);
};

/// How edges diffract light (docs/diffraction.md).
struct DiffractionSettings {
  enum class Model {
    beams,    ///< an edge is a scatterer in beams of that width
    segments  ///< each straight segment has the factor |u/u0|^2 of the edges beside it
  };
  Model model = Model::beams;
  BeamWidth width{};  ///< of the model `beams`
  /// How edges of wedges act on the electric field, in the model `segments`.
  enum class Polarisation {
    none,  ///< as half planes that absorb, without polarisation
    soft,  ///< the electric field lies along each edge
    hard,  ///< the magnetic field lies along each edge
    both   ///< the mean power of soft and hard
  };
  Polarisation polarisation = Polarisation::none;

  bool operator==(const DiffractionSettings&) const = default;
};

/// Where the width of beams does not suit the scene.
class BeamWidthError : public Error {
public:
  using Error::Error;
};

}  // namespace aureole
