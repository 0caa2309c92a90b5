// SPDX-License-Identifier: Apache-2.0
// Light that leaves a slab on the side where a thin beam has entered it, in the diffusion approximation with sources and their
// mirror images about both surfaces (D. Contini, F. Martelli, G. Zaccanti, "Photon migration through a turbid slab described by a
// model based on diffusion approximation. I. Theory", Applied Optics 36(19), 1997). Lengths are in m.
#pragma once

#include <vector>

#include "aureole/optics/medium/diffusion.h"

namespace aureole::optics {

class Multipole {
public:
  /// `index` is the index of refraction of the slab over the index outside, on both sides. Throws std::domain_error if the medium
  /// has no extinction, or if the index or the thickness is not positive.
  Multipole(const DiffusionCoefficients& medium, double index, double thickness);

  /// The power per area (1/m^2) that leaves at a distance from the beam, for 1 W that has entered.
  double profile(double distance) const;
  /// The power that leaves within a distance from the beam: the integral of `profile` over that disc.
  double within(double distance) const;
  /// The integral of `profile` over the plane.
  double total() const { return total_; }
  /// The power per length (1/m) that leaves at a distance from a line of beams: the integral of `profile` along a line.
  double line_profile(double distance) const;

private:
  double effective_, albedo_;
  double period_ = 0;  ///< thickness between the planes where the fluence is extrapolated to zero
  double total_ = 0;
  struct Pair {
    double source, image;  ///< depths of a source and of its image
  };
  std::vector<Pair> pairs_;
};

/// The part of the light that a wide port would return of which a round port of radius `port` returns to a concentric viewed disc of
/// radius `viewed`, both evenly lit and viewed: the chance that light that leaves within the disc has entered through the port.
/// 1 minus this is the edge loss.
double port_part(const Multipole& slab, double viewed, double port);

}  // namespace aureole::optics
