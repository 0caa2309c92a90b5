// SPDX-License-Identifier: Apache-2.0
// Curves with a radius, such as hair: what `linearcurve` and `bsplinecurve` share. Embree meets the rays; the
// point it finds is moved onto the exact surface in double precision.
#pragma once

#include "aureole/plugin/registry.h"
#include "aureole/shape/double3.h"
#include "aureole/shape/unsampled_shape.h"

namespace aureole {

class Curves : public UnsampledShape {
public:
  RTCGeometry make_geometry(RTCDevice device) const final;
  Bounds3 bounds() const final { return bounds_; }
  std::size_t primitive_count() const final { return first_.size(); }
  std::size_t memory_bytes() const final;

  struct ControlPoint {
    Vec3 p;
    float radius;
  };
  const std::vector<ControlPoint>& points() const { return points_; }
  /// The first control point of each segment.
  const std::vector<std::uint32_t>& segments() const { return first_; }

protected:
  /// Reads `filename`: curves of at least `points_per_segment` control points.
  Curves(const Properties& properties, std::uint32_t points_per_segment, RTCGeometryType type);

  const ControlPoint* segment(std::uint32_t primitive) const { return &points_[first_[primitive]]; }
  /// Texture coordinate v for a place along a segment: all segments are of the same length.
  float along_all(std::uint32_t primitive, double v) const {
    return float((double(primitive) + v) / double(first_.size()));
  }
  /// Bound of the distance to the surface at which the ray caster may still see a hit.
  Vec3 point_error(std::uint32_t primitive, const Vec3& p) const;

private:
  void read(const Properties& properties);
  std::uint32_t points_per_segment_;
  RTCGeometryType type_;
  std::vector<ControlPoint> points_;
  std::vector<std::uint32_t> first_;
  Bounds3 bounds_;
};

/// Two unit vectors across the tangent of a curve, `rotation` as near to the z axis as possible; texture
/// coordinate u is the angle from `radius` towards `rotation`, over 2 pi (as Mitsuba 3).
struct CurveFrame {
  Double3 rotation, radius;

  explicit CurveFrame(const Double3& tangent);
  float u_of(const Double3& direction) const;
  Double3 direction(float u) const;
};

/// The rows of the parameter table that both plug-ins share.
std::vector<ParameterDoc> curve_parameters();

}  // namespace aureole
