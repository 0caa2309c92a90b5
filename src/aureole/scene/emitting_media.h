// SPDX-License-Identifier: Apache-2.0
// `EmittingMedia`: emissive media as lights. Each is a region of space, chosen in a light tree; a position in
// it is sampled approximately in proportion to the emission there.
#pragma once

#include <span>
#include <vector>

#include "aureole/math/piecewise.h"
#include "aureole/math/transform.h"
#include "aureole/medium/medium.h"
#include "aureole/scene/light_tree.h"

namespace aureole {

class EmittingMedia {
public:
  /// A medium and a world-space box around the volume that it fills.
  struct Filled {
    const Medium* medium;
    Bounds3 box;
  };
  EmittingMedia() = default;
  /// Tabulates the emission of the media, weighted by the sensor's spectral response. A heterogeneous medium
  /// takes the box of its own grid. Media that emit nothing or fill no volume are left out.
  EmittingMedia(std::span<const Filled> filled, const SampledSpectrum& response);

  bool empty() const { return regions_.empty(); }
  /// Whether light sampling can choose any of the media (see `Medium::sampling_weight`). `sample` and `pdf`
  /// require it.
  bool can_be_connected() const { return can_be_connected_; }

  struct Place {
    const Medium* medium;
    Vec3 p;
    float pdf;  ///< pdf of the position [1/length^3], including the probability of choosing the region
  };
  /// Samples a position in an emissive medium for light sampling at the point `from`, which may lie inside
  /// that medium. `facing` is the normal at `from`; zero if light may arrive from both sides. `u` chooses the
  /// region and the cell, `in_cell` and `third` the position in the cell. Returns false if no position can be
  /// sampled.
  bool sample(const Vec3& from, const Vec3& facing, float u, Vec2 in_cell, float third, Place& out) const;
  /// Returns the pdf [1/length^3] with which `sample` finds the point `p` of this medium.
  float pdf(const Medium& medium, const Vec3& from, const Vec3& facing, const Vec3& p) const;
  /// Samples a position at which a light path starts, by emitted power alone. The random numbers are
  /// used as in `sample`.
  Place sample_by_power(float u, Vec2 in_cell, float third) const;
  /// Returns the inverse size of the medium [1/length], which is approximately the pdf per length with which
  /// a ray through the medium samples emission.
  float inverse_size(const Medium& medium) const;

  /// Emitted power of each region, reduced by self-absorption [W/nm, up to a scale common to all emitters].
  const std::vector<SampledSpectrum>& powers() const { return powers_; }
  /// Total power of all regions, weighted by the sensor's response.
  double power() const { return region_.total(); }

private:
  struct Region {
    const Medium* medium;
    /// transforms between the world and [0, 1]^3, which the grid of cells divides
    Transform to_unit, from_unit;
    std::array<int, 3> cells;
    double volume;
    Piecewise1D cell;

    float pdf(const Vec3& p) const;  ///< pdf of a position within the region; 0 outside the region
    /// Samples a position within this region, with its pdf.
    Place place(float u, const Vec3& in_cell) const;
  };
  static Region region_of(const Filled& filled);

  std::vector<Region> regions_;
  std::vector<SampledSpectrum> powers_;
  LightTree tree_;
  bool can_be_connected_ = false;
  Piecewise1D region_;  ///< distribution of the regions by power
};

}  // namespace aureole
