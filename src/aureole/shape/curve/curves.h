// SPDX-License-Identifier: Apache-2.0
// Curves with a radius, such as hair: the base of `linearcurve` and `bsplinecurve`. Each intersects rays by
// its own method; the hit is then moved onto the exact surface in double precision.
#pragma once

#include "aureole/plugin/registry.h"
#include "aureole/shape/geometry/double3.h"
#include "aureole/shape/shape.h"

namespace aureole {

/// Two unit vectors perpendicular to a curve's tangent, with `rotation` as close to the z axis as possible.
/// The texture coordinate u is the angle from `radius` towards `rotation`, divided by 2 pi (as in Mitsuba 3).
struct CurveFrame {
  Double3 rotation, radius;

  explicit CurveFrame(const Double3& tangent);
  float u_of(const Double3& direction) const;
  Double3 direction(float u) const;
};

/// A point on the surface of a curve.
struct CurvePoint {
  double v;  ///< parameter along the segment
  /// point on the curve; unit vectors along the curve and from that point to the surface
  Double3 center, tangent, out;
  double radius;
  Double3 normal;  ///< surface normal, unit length
};

class Curves : public Shape {
public:
  Bounds3 bounds() const final { return bounds_; }
  std::string opening() const final { return "curves may be open at their ends"; }
  std::size_t primitive_count() const final { return first_.size(); }
  std::size_t memory_bytes() const final;
  SurfacePoint surface_point(const ShapeHit& hit, const Ray& ray, bool tangent) const final;
  std::shared_ptr<const AreaSampler> make_area_sampler(AreaUse use) const final;

  struct ControlPoint {
    Vec3 p;
    float radius;
  };
  const std::vector<ControlPoint>& points() const { return points_; }
  /// Indices of the first control point of each segment.
  const std::vector<std::uint32_t>& segments() const { return first_; }

protected:
  /// Reads `filename`: curves of at least `points_per_segment` control points.
  Curves(const Properties& properties, std::uint32_t points_per_segment);

  const ControlPoint* segment(std::uint32_t primitive) const { return &points_[first_[primitive]]; }
  /// Returns the surface point of a segment nearest to the point `met`, which is close to it. `v` is an
  /// initial guess.
  virtual CurvePoint locate(std::uint32_t primitive, const Double3& met, double v) const = 0;

private:
  void read(const Properties& properties);

  std::uint32_t points_per_segment_;
  std::vector<ControlPoint> points_;
  std::vector<std::uint32_t> first_;
  Bounds3 bounds_;
};

/// Returns the documentation of the parameters that both plug-ins for curves share.
std::vector<ParameterDoc> curve_parameters();

}  // namespace aureole
