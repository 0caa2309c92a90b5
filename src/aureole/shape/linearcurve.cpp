// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "aureole/shape/curve/curves.h"
#include "aureole/shape/geometry/user_geometry.h"

namespace aureole {
namespace {

/// A cone tangent to the spheres of two control points, with these spheres as rounded ends.
struct ConeSegment {
  Double3 start, along;
  double length_along, start_radius, radius_change;

  explicit ConeSegment(const Curves::ControlPoint* c)
      : start(c[0].p),
        along(Double3(c[1].p) - Double3(c[0].p)),
        length_along(length(along)),
        start_radius(c[0].radius),
        radius_change(double(c[1].radius) - double(c[0].radius)) {}

  Double3 tangent() const { return length_along > 0 ? along * (1 / length_along) : Double3(1, 0, 0); }
  /// Sine of half the opening angle; its magnitude is at least 1 if one sphere contains the other.
  double sine() const { return length_along > 0 ? radius_change / length_along : 1; }
  Double3 center(double v) const { return start + along * v; }
  double radius(double v) const { return start_radius + radius_change * v; }

  /// Returns the centre of the tangent sphere nearest to p, as a fraction of the segment's length.
  double place(const Double3& p) const {
    const double s = sine();
    if (!(std::abs(s) < 1)) return radius_change > 0 ? 1 : 0;
    const double x = dot(p - start, along) / length_along;
    return std::clamp((x + start_radius * s) / (length_along * (1 - s * s)), 0.0, 1.0);
  }
  /// Whether the point lies inside by more than rounding.
  bool holds(const Double3& p) const {
    const double v = place(p), r = radius(v) * (1 - 1e-9);
    const Double3 w = p - center(v);
    return dot(w, w) < r * r;
  }
  /// Returns the distance in (t_min, t_max) at which a ray from outside enters the cone.
  std::optional<double> enter(const Double3& o, const Double3& d, double t_min, double t_max) const;
};

std::optional<double> ConeSegment::enter(const Double3& o, const Double3& d, double t_min,
                                         double t_max) const {
  // Distances are computed from the ray's point nearest to the segment's start, so that distant origins lose
  // no precision.
  const double dd = dot(d, d), shift = dot(start - o, d) / dd;
  const Double3 from = o + d * shift - start;
  t_min -= shift, t_max -= shift;
  double best = t_max;
  const auto offer = [&](double t) {
    if (t > t_min && t < best) best = t;
  };

  const double s = sine(), cos2 = 1 - s * s;
  // a point x + reach along the axis belongs to the cone for values from 0 to length * cos2
  double reach = 0;
  const bool is_cone = std::abs(s) < 1;
  const Double3 axis = tangent();
  if (is_cone) {
    // The cone is |p|^2 cos^2 - x^2 = 2 r0 s x + r0^2, with x along the axis; the other nappe has r0 + s x <
    // 0.
    const double x = dot(from, axis), dx = dot(d, axis), r0 = start_radius;
    reach = r0 * s;
    const double a = cos2 * dd - dx * dx, b = x * dx + reach * dx - cos2 * dot(from, d);
    const double c = cos2 * dot(from, from) - x * x - 2 * reach * x - r0 * r0;
    const double discriminant = b * b - a * c;
    if (discriminant >= 0 && a != 0) {
      const double q = b + std::copysign(std::sqrt(discriminant), b);
      const double roots[2] = {q / a, q != 0 ? c / q : 0};
      for (const double t : roots) {
        const double at = x + dx * t, share = (at + reach) / (length_along * cos2);
        // The quadratic decreases where the ray enters.
        if (share >= 0 && share <= 1 && r0 + s * at >= 0 && a * t < b) offer(t);
      }
    }
  }
  for (int end = 0; end < 2; ++end) {
    const double r = start_radius + end * radius_change;
    const Double3 f = end ? from - along : from;
    const double b = -dot(f, d);
    const Double3 across = f + d * (b / dd);
    const double discriminant = r * r - dot(across, across);
    if (!(discriminant >= 0)) continue;
    const double t = (b - std::sqrt(dd * discriminant)) / dd;
    const double x = dot(from + d * t, axis) + reach;
    // Only the part of the sphere outside the cone counts.
    if (!is_cone ? (end == 1) == (radius_change > 0) : end ? x >= length_along * cos2 : x <= 0) offer(t);
  }
  return best < t_max ? std::optional<double>(best + shift) : std::nullopt;
}

class LinearCurve final : public Curves {
public:
  explicit LinearCurve(const Properties& properties) : Curves(properties, 2) {}

  // Returns a user geometry. Embree has such curves as well, but misses many hits for segments shorter than a
  // hundredth of a unit and for rays along the axis.
  RTCGeometry make_geometry(RTCDevice device) const override { return make_user_geometry(device, *this); }
  Bounds3 bounds(std::uint32_t primitive) const {
    const ControlPoint* c = segment(primitive);
    Bounds3 b;
    for (int i = 0; i < 2; ++i) {
      const Vec3 r{c[i].radius, c[i].radius, c[i].radius};
      b.extend(c[i].p - r), b.extend(c[i].p + r);
    }
    return b;
  }
  using Curves::bounds;
  /// Only hits from outside count, as in Mitsuba 3: the inside is invisible, and so is a segment's part
  /// within its neighbours.
  std::optional<double> intersect(std::uint32_t primitive, const Double3& o, const Double3& d, double t_min,
                                  double t_max) const {
    const ControlPoint* c = segment(primitive);
    // Most rays in the bounding box miss the curve; the distance between the two lines rejects them quickly.
    const Double3 n = cross(d, Double3(c[1].p) - Double3(c[0].p));
    const double volume = dot(o - Double3(c[0].p), n), radius = std::max(c[0].radius, c[1].radius);
    if (volume * volume > 1.0001 * radius * radius * dot(n, n) + 1e-300) return {};
    const auto t = ConeSegment(c).enter(o, d, t_min, t_max);
    if (!t) return t;
    const Double3 met = o + d * *t;
    if (primitive > 0 && follows(primitive) && ConeSegment(segment(primitive - 1)).holds(met)) return {};
    if (primitive + 1 < primitive_count() && follows(primitive + 1) &&
        ConeSegment(segment(primitive + 1)).holds(met))
      return {};
    return t;
  }

private:
  /// Whether the segment starts where the previous one ends.
  bool follows(std::uint32_t primitive) const {
    return segments()[primitive] == segments()[primitive - 1] + 1;
  }
  CurvePoint locate(std::uint32_t primitive, const Double3& met, double) const override {
    const ConeSegment cone(segment(primitive));
    const double v = cone.place(met);
    const Double3 center = cone.center(v), out = met - center;
    const double l = length(out);
    const Double3 n = l > 0 ? out * (1 / l) : CurveFrame(cone.tangent()).radius;
    return {v, center, cone.tangent(), n, cone.radius(v), n};
  }
  SurfaceDerivatives own_derivatives(const SurfacePoint& point) const override {
    const ConeSegment cone(segment(point.primitive));
    const CurveFrame frame(cone.tangent());
    const Double3 outward = frame.direction(point.uv.x);
    const double sine = std::clamp(cone.sine(), -1.0, 1.0), cosine = std::sqrt(1 - sine * sine);
    const Double3 n = outward * cosine - cone.tangent() * sine;
    const Double3 around = cross(cone.tangent(), outward);
    return {(around * (2 * kPiD * cosine * cone.radius(point.barycentric.x))).to_float(),
            ((cone.along + n * cone.radius_change) * double(primitive_count())).to_float()};
  }
};

AUREOLE_PLUGIN(LinearCurve, "shape", "linearcurve",
               PluginDoc{.summary = "Piecewise linear curves: cones between spheres around the control "
                                    "points, rounded at joints and ends. Texture coordinates: u runs around "
                                    "the curve, v along all segments of the file in equal steps. The inside "
                                    "is invisible.",
                         .source = "",
                         .parameters = curve_parameters(),
                         .examples = {R"(<shape type="linearcurve">
  <string name="filename" value="curves.txt"/>
  <transform name="to_world"><translate z="1"/></transform>
  <bsdf type="diffuse"/>
</shape>)"},
                         .takes_shared_parameters = false});

}  // namespace
}  // namespace aureole
