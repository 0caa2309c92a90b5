// SPDX-License-Identifier: Apache-2.0
// `PolygonAperture`: an opening bounded by straight edges; it may have holes.
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
  /// Error below 1e-12 of the area at any q, for shapes up to a thousand times as long as wide.
  std::complex<double> transform(double qx, double qy) const override;

private:
  static constexpr int kOrder = 16;  ///< of the moments

  std::complex<double> series(double qx, double qy) const;

  double area_, bounding_radius_;
  PlanePoint centroid_;
  double radius_;  ///< about the centroid
  /// integral of x^a y^b / (a! b! radius^(a+b)) about the centroid, times (-1)^((a+b)/2), by a + b, then a
  std::vector<double> moments_;
  // Vertices of all rings, each closed by its first vertex, padded to whole vectors; the edge of a vertex
  // leads to the next one and is 0 after the last of a ring.
  std::vector<double> x_, y_, edge_x_, edge_y_;
};

}  // namespace aureole::optics
