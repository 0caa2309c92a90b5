// SPDX-License-Identifier: Apache-2.0
// Sampling of diffuse directions for `correlated_spheres`: a ring of scattering angles in proportion to its
// power, then an azimuth about the forward direction. Both are tabulated for some angles of incidence and
// wavelengths, of which the nearest is used; the pdf is exactly that of the tables.
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

  /// Fills the tables of one wavelength from the phase function at the angle nodes and from the other factors
  /// of the radiance, including the cosine. Different wavelengths may be filled concurrently.
  using Factor = std::function<double(float transverse, float cos_o)>;
  void prepare(int wavelength, const std::vector<double>& phase, const Factor& factor);

  Vec3 sample(const Vec3& wi, Vec2 u, int wavelength) const;
  /// The pdf [1/sr] of a wavelength is ring[wavelength] * azimuth[wavelength].
  struct Density {
    const float *ring, *azimuth;
  };
  Density density(const Vec3& wi, const Vec3& wo, int cell) const;

  std::size_t bytes() const { return sizeof(float) * (ring_.size() + cdf_.size() + azimuth_.size()); }

  template <class Self, class Fields>
  static void fields(Self& self, Fields& all) {
    all(self.angles_, self.wavelengths_, self.ring_, self.cdf_, self.azimuth_);
  }

private:
  static constexpr int kTilts = 16;         // angles of incidence, uniform in the cosine
  static constexpr int kBins = 16;          // bins of the azimuth, over half a turn
  static constexpr int kGroups = 128;       // groups of rings with their own azimuths; the last is uniform
  static constexpr int kCellsPerGroup = 2;  // cells of a group, counted from the forward direction

  static int tilt(float z) { return int(std::min(std::abs(z), 1.f) * (kTilts - 1) + 0.5f); }
  /// Returns the group of a cell; cells beyond all groups, counted from the forward direction, belong to the
  /// last.
  int group(int cell) const { return std::min((angles_.cells() - 1 - cell) / kCellsPerGroup, kGroups); }
  std::size_t azimuth_row(int tilt, int group, int bin) const {
    return ((std::size_t(tilt) * (kGroups + 1) + std::size_t(group)) * kBins + std::size_t(bin)) *
           std::size_t(wavelengths_);
  }

  SphereAngles angles_;
  int wavelengths_ = 0;
  std::vector<float> ring_;  // density per solid angle by [tilt][cell][wavelength]
  std::vector<float> cdf_;   // cumulative distribution by [tilt][wavelength][cell]
  // density of azimuths relative to a uniform one, by [tilt][group][bin][wavelength]
  std::vector<float> azimuth_;
};

}  // namespace aureole
