// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "aureole/shape/curves.h"

namespace aureole {
namespace {

constexpr double kPiD = 3.14159265358979323846;

/// A cone that touches the spheres of two control points, continued by them at both ends.
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
  /// Sine of half the opening angle; not below 1 in size where one sphere holds the other.
  double sine() const { return length_along > 0 ? radius_change / length_along : 1; }
  Double3 center(double v) const { return start + along * v; }
  double radius(double v) const { return start_radius + radius_change * v; }

  /// The centre, as a share of the length, of the sphere that touches the surface nearest to p.
  double place(const Double3& p) const {
    const double s = sine();
    if (!(std::abs(s) < 1)) return radius_change > 0 ? 1 : 0;
    const double x = dot(p - start, along) / length_along;
    return std::clamp((x + start_radius * s) / (length_along * (1 - s * s)), 0.0, 1.0);
  }
};

class LinearCurve final : public Curves {
public:
  explicit LinearCurve(const Properties& properties)
      : Curves(properties, 2, RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE) {}

  SurfacePoint surface_point(const ShapeHit& hit, const Ray& ray) const override {
    const ConeSegment cone(segment(hit.primitive));
    const Double3 met = Double3(ray.o) + Double3(ray.d) * double(hit.t);
    const double v = cone.place(met);
    const CurveFrame frame(cone.tangent());
    Double3 out = met - cone.center(v);
    const double l = length(out);
    out = l > 0 ? out * (1 / l) : frame.radius;
    SurfacePoint s;
    s.p = (cone.center(v) + out * cone.radius(v)).to_float();
    s.p_error = point_error(hit.primitive, s.p);
    s.ng = out.to_float();
    s.uv = {frame.u_of(out), along_all(hit.primitive, v)};
    s.shading = Frame::from_normal_tangent(s.ng, cross(cone.tangent(), out).to_float());
    s.shape = this;
    s.primitive = hit.primitive;
    s.barycentric = {float(v), 0};
    return s;
  }

private:
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
               PluginDoc{.summary = "Curves of straight pieces: cones between the spheres around the control "
                                    "points, rounded at joints "
                                    "and ends. Texture coordinates: u runs around, v along all pieces of the "
                                    "file, of equal length each. "
                                    "The inside is not seen.",
                         .source = "",
                         .parameters = curve_parameters(),
                         .examples = {R"(<shape type="linearcurve">
  <string name="filename" value="curves.txt"/>
  <transform name="to_world"><translate z="1"/></transform>
  <bsdf type="diffuse"/>
</shape>)"}});

}  // namespace
}  // namespace aureole
