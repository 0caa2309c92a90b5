// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "aureole/shape/curve/curves.h"

namespace aureole {
namespace {

/// A point of a uniform cubic B-spline and its radius, with their derivatives with respect to v.
struct SplinePoint {
  Double3 c, dc, ddc;
  double r, dr;

  SplinePoint(const Curves::ControlPoint* p, double v) {
    const double w = 1 - v;
    const double b[4] = {w * w * w / 6, (3 * v * v * v - 6 * v * v + 4) / 6,
                         (3 * w * w * w - 6 * w * w + 4) / 6, v * v * v / 6};
    const double db[4] = {-w * w / 2, (3 * v * v - 4 * v) / 2, (4 * w - 3 * w * w) / 2, v * v / 2};
    const double ddb[4] = {w, 3 * v - 2, 3 * w - 2, v};
    r = dr = 0;
    for (int i = 0; i < 4; ++i) {
      const Double3 at(p[i].p);
      c = c + at * b[i], dc = dc + at * db[i], ddc = ddc + at * ddb[i];
      r += p[i].radius * b[i], dr += p[i].radius * db[i];
    }
  }
  Double3 tangent() const {
    const double l = length(dc);
    return l > 0 ? dc * (1 / l) : Double3(1, 0, 0);
  }
};

class BSplineCurve final : public Curves {
public:
  explicit BSplineCurve(const Properties& properties) : Curves(properties, 4) {}

  RTCGeometry make_geometry(RTCDevice device) const override;
  /// Whether Embree's hit at distance t is on the outer side of the surface.
  bool is_outside_hit(std::uint32_t primitive, float u, const Double3& o, const Double3& d, double t) const;

private:
  CurvePoint locate(std::uint32_t primitive, const Double3& met, double v) const override {
    const ControlPoint* control = segment(primitive);
    // Embree's hits have a tolerance, which two Newton steps correct: they find the v whose cross-section
    // plane contains the point.
    for (int i = 0; i < 2; ++i) {
      const SplinePoint at(control, v);
      const double slope = dot(met - at.c, at.ddc) - dot(at.dc, at.dc);
      if (slope < 0) v = std::clamp(v - dot(met - at.c, at.dc) / slope, 0.0, 1.0);
    }
    const SplinePoint at(control, v);
    const Double3 tangent = at.tangent();
    Double3 out = met - at.c;
    out = out - tangent * dot(out, tangent);
    const double l = length(out);
    out = l > 0 ? out * (1 / l) : CurveFrame(tangent).radius;
    // Cross-sections of a bent curve are tilted to each other, so that the normal is the normal of the
    // surface that they sweep.
    const Double3 n = out * (dot(at.dc, at.dc) - at.r * dot(out, at.ddc)) - at.dc * at.dr;
    const double n_length = length(n);
    return {v, at.c, tangent, out, at.r, n_length > 0 ? n * (1 / n_length) : out};
  }
  /// Derivatives of p = c + r e, e = radius cos 2 pi u + rotation sin 2 pi u; the frame rotates with v as
  /// well.
  SurfaceDerivatives own_derivatives(const SurfacePoint& point) const override {
    const SplinePoint at(segment(point.primitive), point.barycentric.x);
    const Double3 t = at.tangent();
    const CurveFrame frame(t);
    const double phi = 2 * kPiD * point.uv.x, speed = length(at.dc);
    const Double3 e = frame.direction(point.uv.x);
    const Double3 dt = speed > 0 ? (at.ddc - t * dot(at.ddc, t)) * (1 / speed) : Double3();
    // The vector `rotation` is guide / |guide| with guide = z - t t_z.
    const Double3 guide = Double3(0, 0, 1) - t * t.z, d_guide = t * -dt.z - dt * t.z;
    const double l = length(guide);
    const Double3 d_rotation =
        l > 1e-4 ? (d_guide - frame.rotation * dot(frame.rotation, d_guide)) * (1 / l) : Double3();
    const Double3 d_radius = cross(d_rotation, t) + cross(frame.rotation, dt);
    const Double3 de = d_radius * std::cos(phi) + d_rotation * std::sin(phi);
    const Double3 around = frame.rotation * std::cos(phi) - frame.radius * std::sin(phi);
    return {(around * (2 * kPiD * at.r)).to_float(),
            ((at.dc + e * at.dr + de * at.r) * double(primitive_count())).to_float()};
  }
};

void reject_inside(const RTCFilterFunctionNArguments* args) {
  const auto& curves = *static_cast<const BSplineCurve*>(args->geometryUserPtr);
  RTCRayN* r = args->ray;
  const unsigned n = args->N;
  for (unsigned i = 0; i < n; ++i) {
    if (args->valid[i] != -1) continue;
    const Double3 o(RTCRayN_org_x(r, n, i), RTCRayN_org_y(r, n, i), RTCRayN_org_z(r, n, i));
    const Double3 d(RTCRayN_dir_x(r, n, i), RTCRayN_dir_y(r, n, i), RTCRayN_dir_z(r, n, i));
    if (!curves.is_outside_hit(RTCHitN_primID(args->hit, n, i), RTCHitN_u(args->hit, n, i), o, d,
                               RTCRayN_tfar(r, n, i)))
      args->valid[i] = 0;
  }
}

RTCGeometry BSplineCurve::make_geometry(RTCDevice device) const {
  RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_ROUND_BSPLINE_CURVE);
  static_assert(sizeof(ControlPoint) == 16);
  rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, points().data(), 0,
                             sizeof(ControlPoint), points().size());
  rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, segments().data(), 0,
                             sizeof(std::uint32_t), segments().size());
  rtcSetGeometryUserData(g, const_cast<BSplineCurve*>(this));
  rtcSetGeometryIntersectFilterFunction(g, reject_inside);
  rtcSetGeometryOccludedFilterFunction(g, reject_inside);
  rtcCommitGeometry(g);
  return g;
}

bool BSplineCurve::is_outside_hit(std::uint32_t primitive, float u, const Double3& o, const Double3& d,
                                  double t) const {
  // The inside is invisible (as in Mitsuba 3): a ray that starts inside, or enters at an open end, continues.
  // Embree's hits have a tolerance: near grazing incidence, rays that leave the surface may hit it again.
  const CurvePoint at = locate(primitive, o + d * t, u);
  if (dot(at.normal, d) > 0) return false;
  // Hits behind a ray that starts just inside are ignored as well.
  if (t * length(d) > at.radius) return true;
  const CurvePoint start = locate(primitive, o, u);
  const Double3 from_axis = o - start.center;
  return length(from_axis - start.tangent * dot(from_axis, start.tangent)) >= start.radius;
}

AUREOLE_PLUGIN(
    BSplineCurve, "shape", "bsplinecurve",
    PluginDoc{
        .summary =
            "Uniform cubic B-spline curves with a radius: open tubes, closed where the radius is zero. "
            "Texture coordinates: u runs around the curve, v along all segments of the file in equal steps. "
            "The inside is invisible.",
        .source = "",
        .parameters = curve_parameters(),
        .examples = {R"(<shape type="bsplinecurve">
  <string name="filename" value="curves.txt"/>
  <transform name="to_world"><scale value="2"/></transform>
  <bsdf type="diffuse"/>
</shape>)"},
        .takes_shared_parameters = false});

}  // namespace
}  // namespace aureole
