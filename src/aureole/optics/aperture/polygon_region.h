// SPDX-License-Identifier: Apache-2.0
// `PolygonRegion`: a region of the plane bounded by closed rings of straight edges, validated and in a normal
// form: outer rings are counter-clockwise, holes clockwise, and no two edges cross.
#pragma once

#include <cstddef>
#include <vector>

namespace aureole::optics {

struct PlanePoint {
  double x = 0, y = 0;
};
using Ring = std::vector<PlanePoint>;

class PolygonRegion {
public:
  static constexpr std::size_t kMaxVertices = 10000;

  /// Makes the region by the even-odd rule: points that an odd number of rings surround, for any orientation.
  /// A ring in a ring is a hole, and the intersection of overlapping rings is excluded. A first point
  /// repeated at the end is dropped.
  /// Throws std::domain_error if a ring touches or crosses itself, if the region is empty, if a coordinate is
  /// not finite, or for more than kMaxVertices. The message has coordinates in the units of the points.
  static PolygonRegion even_odd(std::vector<Ring> rings);

  const std::vector<Ring>& rings() const { return rings_; }
  double area() const { return area_; }
  PlanePoint centroid() const { return centroid_; }
  /// Returns a corner of the bounding box.
  PlanePoint lower() const { return lower_; }
  PlanePoint upper() const { return upper_; }

  /// Returns the region with every point p moved to scale (p - origin); scale > 0.
  PolygonRegion placed(PlanePoint origin, double scale) const;

private:
  explicit PolygonRegion(std::vector<Ring> rings);

  std::vector<Ring> rings_;
  double area_ = 0;
  PlanePoint centroid_, lower_, upper_;
};

}  // namespace aureole::optics
