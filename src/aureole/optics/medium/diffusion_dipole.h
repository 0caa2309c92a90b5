// SPDX-License-Identifier: Apache-2.0
// Light that leaves a half-space after a thin beam has entered it, in the diffusion approximation with a
// source in the medium and its mirror image above (Farrell, Patterson & Wilson 1992; Jensen, Marschner, Levoy
// & Hanrahan 2001, "A practical model for subsurface light transport", equation 4). Lengths are in m.
#pragma once

#include "aureole/optics/medium/diffusion.h"

namespace aureole::optics {

class Dipole {
public:
  /// `index` is the index of refraction of the half-space over the index outside. A medium without scattering
  /// returns no light. Throws std::domain_error if the medium has no extinction or the index is not positive.
  Dipole(const DiffusionCoefficients& medium, double index);

  double source_depth() const { return source_; }  ///< depth of the source, 1/sigma_tr
  double image_height() const { return image_; }   ///< height of the source's mirror image above the surface
  /// effective attenuation coefficient sqrt(3 sigma_a sigma_tr), 1/m
  double effective() const { return effective_; }
  double albedo() const { return albedo_; }  ///< reduced albedo

  /// Returns the power per area (1/m^2) that leaves at a distance from the beam, for 1 W that has entered.
  double profile(double distance) const;
  /// Returns the integral of `profile` over the plane.
  double total() const;

private:
  double source_, image_, effective_, albedo_;
};

/// Returns the total reflectance in closed form, alpha/2 (1 + exp(-4/3 A s)) exp(-s) with s = sqrt(3 (1 -
/// alpha)), alpha the reduced albedo and A = (1 + F)/(1 - F), F the diffuse Fresnel reflectance from inside
/// (Jensen et al. 2001, section 4.2).
double dipole_reflectance(double reduced_albedo, double index);

/// Returns the reduced albedo at which `dipole_reflectance` is `reflectance`. Throws std::domain_error unless
/// `reflectance` is in [0, 1].
double dipole_albedo(double reflectance, double index);

}  // namespace aureole::optics
