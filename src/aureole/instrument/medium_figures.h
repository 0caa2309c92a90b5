// SPDX-License-Identifier: Apache-2.0
// Optical properties of a medium by wavelength, in SI units: measured with its own functions, so that this
// works for any medium.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "aureole/medium/medium.h"

namespace aureole {

struct MediumFigures {
  double nm = 0;
  double absorption = 0, scattering = 0;  ///< coefficients, 1/m
  double asymmetry = 0;                   ///< mean cosine of the scattering angle; 0 where nothing scatters

  double extinction() const { return absorption + scattering; }
  double albedo() const { return extinction() > 0 ? scattering / extinction() : 0; }
  double mean_free_path() const { return 1 / extinction(); }  ///< m; infinite where there is nothing
  /// Part of the light that passes `length` m neither absorbed nor scattered.
  double transmittance(double length) const;
};

/// At a point of the world, for light along the unit vector `d`; `nm` within the range of the scene.
std::vector<MediumFigures> measure_medium(const Medium& medium, std::span<const double> nm, const Vec3& p,
                                          const Vec3& d);

/// Values [1/sr] of the phase function at scattering angles in rad, for light along `d`: the mean over
/// directions about it.
std::vector<double> phase_over_angle(const Medium& medium, double nm, std::span<const double> angles,
                                     const Vec3& p, const Vec3& d);

/// X, Y, Z of CIE D65, whose Y is 1, behind `length` m of the medium; with `scattered_too` all that is not
/// absorbed counts, as if scattered light went the same way.
std::array<double, 3> colour_behind(const Medium& medium, double length, bool scattered_too, const Vec3& p,
                                    const Vec3& d);

}  // namespace aureole
