// SPDX-License-Identifier: Apache-2.0
// How `correlated_spheres` draws directions of diffuse light: a ring of scattering angles in proportion to
// the power it gets, then an azimuth about the way straight on. Both are tabulated for some angles of
// incidence and wavelengths, of which the nearest is taken; the density is exactly that of the tables.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "aureole/bsdf/spheres/sphere_angles.h"
#include "aureole/math/vec.h"

namespace aureole {

class SphereSamples {
public:
  SphereSamples() = default;
  SphereSamples(const SphereAngles& angles, int wavelengths);

  /// Fills the tables of one wavelength from the phase function at the nodes of the angles and from the other
  /// factors of the radiance, cosine included. Wavelengths may be filled at the same time.
  using Factor = std::function<double(float transverse, float cos_o)>;
  void prepare(int wavelength, const std::vector<double>& phase, const Factor& factor);

  Vec3 sample(const Vec3& wi, Vec2 u, int wavelength) const;
  /// Density [1/sr] of one wavelength is at [wavelength] of the one table times at [wavelength] of the other.
  struct Density {
    const float *ring, *azimuth;
  };
  Density density(const Vec3& wi, const Vec3& wo, int cell) const;

  std::size_t bytes() const { return sizeof(float) * (ring_.size() + cdf_.size() + azimuth_.size()); }

private:
  static constexpr int kTilts = 16;         // angles of incidence, uniform in the cosine
  static constexpr int kBins = 16;          // of the azimuth, over half a turn
  static constexpr int kGroups = 128;       // of rings with azimuths of their own: the last is uniform
  static constexpr int kCellsPerGroup = 2;  // from straight on

  static int tilt(float z) { return int(std::min(std::abs(z), 1.f) * (kTilts - 1) + 0.5f); }
  /// The group of a cell; cells farther from straight on than all groups belong to the last.
  int group(int cell) const { return std::min((angles_.cells() - 1 - cell) / kCellsPerGroup, kGroups); }
  std::size_t azimuth_row(int tilt, int group, int bin) const {
    return ((std::size_t(tilt) * (kGroups + 1) + std::size_t(group)) * kBins + std::size_t(bin)) *
           std::size_t(wavelengths_);
  }

  SphereAngles angles_;
  int wavelengths_ = 0;
  std::vector<float> ring_;     // [tilt][cell][wavelength]: density per solid angle
  std::vector<float> cdf_;      // [tilt][wavelength][cell]
  std::vector<float> azimuth_;  // [tilt][group][bin][wavelength]: density relative to a uniform one
};

}  // namespace aureole
