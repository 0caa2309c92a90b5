// SPDX-License-Identifier: Apache-2.0
// `PolygonAperture`: an aperture bounded by straight edges, possibly with holes.
#pragma once

#include <array>
#include <vector>

#include "aureole/optics/aperture/aperture_shape.h"
#include "aureole/optics/aperture/polygon_region.h"

namespace aureole::optics {

class PolygonAperture final : public ApertureShape {
public:
  explicit PolygonAperture(const PolygonRegion& region);

  double area() const override { return area_; }
  double bounding_radius() const override { return bounding_radius_; }
  /// Returns F(q) with an error below 1e-12 of the area at any q, for shapes with an aspect ratio of up to
  /// 1000.
  std::complex<double> transform(double qx, double qy) const override;

private:
  static constexpr int kOrder = 16;  ///< order of the moments

  std::complex<double> series(double qx, double qy) const;

  double area_, bounding_radius_;
  PlanePoint centroid_;
  double radius_;  ///< bounding radius about the centroid
  /// The integral of x^a y^b / (a! b! radius^(a+b)) about the centroid, times (-1)^((a+b)/2), in the order of
  /// a + b, then a.
  std::vector<double> moments_;
  // Vertices and edges of all rings. Each ring is closed by its first vertex, and the arrays are padded to
  // whole vectors. The edge of a vertex leads to the next vertex; at the last vertex of a ring it is 0.
  std::vector<double> x_, y_, edge_x_, edge_y_;
};

}  // namespace aureole::optics
