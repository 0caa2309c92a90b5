// SPDX-License-Identifier: Apache-2.0
// `EmittingMedia`: media that emit, as lights: a region of space for each, found in a tree as lights are, and
// a place in it, drawn about as it emits.
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
  /// A medium, and a box of the world around what it fills.
  struct Filled {
    const Medium* medium;
    Bounds3 box;
  };
  EmittingMedia() = default;
  /// Tabulates what the media emit, as a sensor of that response sees it. Media that vary have the box of
  /// their own grid; what emits nothing, or fills no volume, is left out.
  EmittingMedia(std::span<const Filled> filled, const SampledSpectrum& response);

  bool empty() const { return regions_.empty(); }
  /// Whether connections look for any of them (`Medium::sampling_weight`): requirement of `sample` and `pdf`.
  bool can_be_connected() const { return can_be_connected_; }

  struct Place {
    const Medium* medium;
    Vec3 p;
    float pdf;  ///< [1/length^3], the choice of the region included
  };
  /// A place for the point `from` with the normal `facing` (zero: light may reach it from both sides), at
  /// which the medium may be or not. `u` chooses the region and the cell, `in_cell` and `third` the place in
  /// it. False where there is none.
  bool sample(const Vec3& from, const Vec3& facing, float u, Vec2 in_cell, float third, Place& out) const;
  /// The density of that place of the medium.
  float pdf(const Medium& medium, const Vec3& from, const Vec3& facing, const Vec3& p) const;
  /// A place for a path that starts there, by power alone; the numbers as above.
  Place sample_by_power(float u, Vec2 in_cell, float third) const;
  /// Inverse of the size of a medium [1/length], the scale of the emission that one path through it finds.
  float inverse_size(const Medium& medium) const;

  /// The power of each region [W/nm up to the scale of all emitters], as far as it leaves it.
  const std::vector<SampledSpectrum>& powers() const { return powers_; }
  /// Power of all regions, weighted by the sensor's response.
  double power() const { return region_.total(); }

private:
  struct Region {
    const Medium* medium;
    Transform to_unit, from_unit;  ///< from the world to [0, 1]^3, of which the cells are equal parts
    std::array<int, 3> cells;
    double volume;
    Piecewise1D cell;

    float pdf(const Vec3& p) const;  ///< zero outside
    /// The place and its density in this region.
    Place place(float u, const Vec3& in_cell) const;
  };
  static Region region_of(const Filled& filled);

  std::vector<Region> regions_;
  std::vector<SampledSpectrum> powers_;
  LightTree tree_;
  bool can_be_connected_ = false;
  Piecewise1D region_;  ///< by power
};

}  // namespace aureole
