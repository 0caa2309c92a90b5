// SPDX-License-Identifier: Apache-2.0
#include "aureole/shape/sphere_geometry.h"

#include <algorithm>

namespace aureole {

namespace {

constexpr double kPiD = 3.14159265358979323846;

/// A right-handed pair of unit vectors across the unit vector n (Duff et al. 2017, "Building an orthonormal
/// basis, revisited").
void make_basis(const Double3& n, Double3& s, Double3& t) {
  const double sign = std::copysign(1.0, n.z), a = -1 / (sign + n.z), b = n.x * n.y * a;
  s = {1 + sign * n.x * n.x * a, sign * b, -sign * n.x};
  t = {b, sign + n.y * n.y * a, -n.y};
}

void ball_bounds(const RTCBoundsFunctionArguments* args) {
  const Bounds3 b = static_cast<const Ball*>(args->geometryUserPtr)->bounds();
  RTCBounds& r = *args->bounds_o;
  r.lower_x = b.lower.x, r.lower_y = b.lower.y, r.lower_z = b.lower.z;
  r.upper_x = b.upper.x, r.upper_y = b.upper.y, r.upper_z = b.upper.z;
}

/// The distance at which ray i of a packet of n meets the ball.
std::optional<float> packet_hit(const Ball& ball, RTCRayN* rays, unsigned n, unsigned i) {
  const Double3 o(RTCRayN_org_x(rays, n, i), RTCRayN_org_y(rays, n, i), RTCRayN_org_z(rays, n, i));
  const Double3 d(RTCRayN_dir_x(rays, n, i), RTCRayN_dir_y(rays, n, i), RTCRayN_dir_z(rays, n, i));
  const float near = RTCRayN_tnear(rays, n, i), far = RTCRayN_tfar(rays, n, i);
  const auto t = ball.intersect(o, d, near, far);
  return t ? std::optional<float>(std::min(float(*t), far)) : std::nullopt;
}

void ball_intersect(const RTCIntersectFunctionNArguments* args) {
  const Ball& ball = *static_cast<const Ball*>(args->geometryUserPtr);
  const unsigned n = args->N;
  RTCRayN* rays = RTCRayHitN_RayN(args->rayhit, n);
  RTCHitN* hits = RTCRayHitN_HitN(args->rayhit, n);
  for (unsigned i = 0; i < n; ++i) {
    if (args->valid[i] != -1) continue;
    const auto t = packet_hit(ball, rays, n, i);
    if (!t) continue;
    RTCRayN_tfar(rays, n, i) = *t;
    // surface_point finds everything else from the distance.
    RTCHitN_Ng_x(hits, n, i) = 0, RTCHitN_Ng_y(hits, n, i) = 0, RTCHitN_Ng_z(hits, n, i) = 1;
    RTCHitN_u(hits, n, i) = 0, RTCHitN_v(hits, n, i) = 0;
    RTCHitN_primID(hits, n, i) = args->primID;
    RTCHitN_geomID(hits, n, i) = args->geomID;
    RTCHitN_instID(hits, n, i, 0) = args->context->instID[0];
  }
}

void ball_occluded(const RTCOccludedFunctionNArguments* args) {
  const Ball& ball = *static_cast<const Ball*>(args->geometryUserPtr);
  for (unsigned i = 0; i < args->N; ++i)
    if (args->valid[i] == -1 && packet_hit(ball, args->ray, args->N, i))
      RTCRayN_tfar(args->ray, args->N, i) = -std::numeric_limits<float>::infinity();
}

}  // namespace

Bounds3 Ball::bounds() const {
  Bounds3 b;
  const double c[3] = {center.x, center.y, center.z};
  for (int i = 0; i < 3; ++i) {
    b.lower[i] = std::nextafter(float(c[i] - radius), -kInfinity);
    b.upper[i] = std::nextafter(float(c[i] + radius), kInfinity);
  }
  return b;
}

std::optional<double> Ball::intersect(const Double3& o, const Double3& d, double t_min, double t_max) const {
  const Double3 f = o - center;
  const double a = dot(d, d), b = -dot(f, d), c = dot(f, f) - radius * radius;
  // The discriminant from the distance between centre and line: no cancellation for far balls (Haines et al.
  // 2019).
  const Double3 across = f + d * (b / a);
  const double discriminant = radius * radius - dot(across, across);
  if (!(discriminant >= 0)) return std::nullopt;
  const double q = b + std::copysign(std::sqrt(a * discriminant), b);
  double t0 = q != 0 ? c / q : 0, t1 = q / a;
  if (t0 > t1) std::swap(t0, t1);
  if (t0 > t_min) return t0 < t_max ? std::optional<double>(t0) : std::nullopt;
  return t1 > t_min && t1 < t_max ? std::optional<double>(t1) : std::nullopt;
}

bool Ball::sees_from_outside(const Double3& reference) const {
  const Double3 w = center - reference;
  return dot(w, w) > radius * radius * (inward ? 1 + 1e-5 : 1.0);
}

bool Ball::is_self(const Double3& reference, double distance) const {
  const Double3 w = center - reference;
  return distance < 1e-5 * radius && dot(w, w) > radius * radius * (1 - 1e-5);
}

float Ball::visible_pdf(const Double3& reference) const {
  if (!sees_from_outside(reference)) return float(1 / (4 * kPiD));
  const Double3 w = center - reference;
  const double sin2 = radius * radius / dot(w, w);
  // 1 - cos of the cone without cancellation.
  return float(1 / (2 * kPiD * sin2 / (1 + std::sqrt(1 - sin2))));
}

std::optional<Double3> Ball::sample_visible(const Double3& reference, Vec2 u) const {
  const Double3 w = center - reference;
  const double phi = 2 * kPiD * u.y, cos_phi = std::cos(phi), sin_phi = std::sin(phi);
  if (!sees_from_outside(reference)) {
    const double z = 1 - 2 * double(u.x), r = std::sqrt(std::max(0.0, 1 - z * z));
    const Double3 d(r * cos_phi, r * sin_phi, z);
    // The far root of the quadratic: for a point on the surface the near one is the point itself, and so is
    // the far one for a direction that leads out.
    const Double3 f = reference - center;
    const double b = -dot(f, d);
    const Double3 across = f + d * b;
    const double discriminant = radius * radius - dot(across, across);
    if (!(discriminant >= 0)) return std::nullopt;
    const double t = b + std::sqrt(discriminant);
    if (!(t > 0) || is_self(reference, t)) return std::nullopt;
    return normalize(f + d * t);
  }
  const double distance_squared = dot(w, w), sin2_max = radius * radius / distance_squared;
  const double one_minus_cos = u.x * sin2_max / (1 + std::sqrt(1 - sin2_max));
  const double cos_theta = 1 - one_minus_cos, sin2 = one_minus_cos * (2 - one_minus_cos);
  // The angle at the centre between the reference point and the visible point (Pharr, Jakob & Humphreys 2023,
  // section 6.2.4).
  const double cos_alpha =
      sin2 / std::sqrt(sin2_max) + cos_theta * std::sqrt(std::max(0.0, 1 - sin2 / sin2_max));
  const double sin_alpha = std::sqrt(std::max(0.0, 1 - cos_alpha * cos_alpha));
  const Double3 n = w * (-1 / std::sqrt(distance_squared));
  Double3 s, t;
  make_basis(n, s, t);
  return s * (sin_alpha * cos_phi) + t * (sin_alpha * sin_phi) + n * cos_alpha;
}

RTCGeometry make_sphere_geometry(RTCDevice device, const Ball& ball) {
  RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(g, 1);
  rtcSetGeometryUserData(g, const_cast<Ball*>(&ball));
  rtcSetGeometryBoundsFunction(
      g, [](const RTCBoundsFunctionArguments* args) { ball_bounds(args); }, nullptr);
  rtcSetGeometryIntersectFunction(g, ball_intersect);
  rtcSetGeometryOccludedFunction(g, ball_occluded);
  rtcCommitGeometry(g);
  return g;
}

}  // namespace aureole
