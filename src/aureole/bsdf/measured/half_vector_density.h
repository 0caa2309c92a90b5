// SPDX-License-Identifier: Apache-2.0
// A sampling density for measured surfaces that have none of their own: a table of f |cos theta_o| over half vectors, for
// a number of directions of incidence, with a small part of cosine-distributed directions.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "aureole/bsdf/measured/bilinear_warp.h"
#include "aureole/math/vec.h"

namespace aureole {

class HalfVectorDensity {
public:
  struct Resolution {
    int angles = 24;              ///< number of angles of incidence
    int azimuths = 1;             ///< number of azimuths of incidence; 1: the surface is isotropic
    int width = 96, height = 32;  ///< nodes of the square of half vectors
  };
  /// `value` returns f |cos theta_o|, averaged over wavelengths, for directions above the surface; it is called from
  /// several threads.
  HalfVectorDensity(const Resolution& resolution,
                    const std::function<float(const Vec3& wi, const Vec3& wo)>& value);

  /// The pdf [1/sr] of sampling wo; both directions lie above the surface.
  float pdf(const Vec3& wi, const Vec3& wo) const;
  /// Samples a direction, which may lie below the surface.
  Vec3 sample(const Vec3& wi, Vec2 u) const;
  /// The reflected fraction of the light from each direction of incidence, by quadrature over the table: angles of
  /// incidence [rad] with the largest fraction over the azimuths.
  struct Energy {
    double theta, fraction;
  };
  const std::vector<Energy>& energies() const { return energies_; }
  std::size_t bytes() const { return warp_.bytes(); }

private:
  struct Incidence {
    SliceBlend blend;
    float cos_phi, sin_phi;
  };
  Incidence incidence(const Vec3& wi) const;

  bool is_isotropic_;
  SliceNodes nodes_;
  BilinearWarp warp_;
  std::vector<Energy> energies_;
};

/// A note about the largest of the energies, if it exceeds one by more than 0.5 %; else an empty text.
std::string energy_note(const std::vector<HalfVectorDensity::Energy>& energies);

}  // namespace aureole
