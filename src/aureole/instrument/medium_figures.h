// SPDX-License-Identifier: Apache-2.0
// Optical properties of a medium by wavelength, in SI units. They are measured through the medium interface
// and so work for any medium.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "aureole/medium/medium.h"

namespace aureole {

struct MediumFigures {
  double nm = 0;
  double absorption = 0, scattering = 0;  ///< coefficients [1/m]
  double asymmetry = 0;                   ///< mean cosine of the scattering angle; 0 without scattering

  double extinction() const { return absorption + scattering; }
  double albedo() const { return extinction() > 0 ? scattering / extinction() : 0; }
  /// mean free path [m]; infinite for zero extinction
  double mean_free_path() const { return 1 / extinction(); }
  /// Fraction of light neither absorbed nor scattered over `length` [m].
  double transmittance(double length) const;
  /// Decadic absorbances lg(1/T) over `length` [m], by absorption alone and by extinction (optical density).
  double absorbance(double length) const;
  double optical_density(double length) const;
};

/// Measures at a world point, for light along the unit vector `d`; `nm` must be within the scene's range.
std::vector<MediumFigures> measure_medium(const Medium& medium, std::span<const double> nm, const Vec3& p,
                                          const Vec3& d);

/// Values [1/sr] of the phase function at scattering angles in rad, for light along `d`: the mean over
/// azimuths about `d`.
std::vector<double> phase_over_angle(const Medium& medium, double nm, std::span<const double> angles,
                                     const Vec3& p, const Vec3& d);

/// X, Y, Z of CIE D65, whose Y is 1, after `length` [m] of the medium. With `scattered_too`, only absorption
/// is applied, as if scattered light continued in its direction.
std::array<double, 3> colour_behind(const Medium& medium, double length, bool scattered_too, const Vec3& p,
                                    const Vec3& d);

}  // namespace aureole
