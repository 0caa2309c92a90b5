// SPDX-License-Identifier: Apache-2.0
#include "aureole/shape/geometry/sphere_geometry.h"

#include <algorithm>

#include "aureole/shape/geometry/user_geometry.h"

namespace aureole {

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
  // The discriminant is computed from the distance between centre and line, without cancellation for distant
  // spheres (Haines et al. 2019).
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
  // Denominator 1 - cos of the cone's half-angle, without cancellation.
  return float(1 / (2 * kPiD * sin2 / (1 + std::sqrt(1 - sin2))));
}

std::optional<Double3> Ball::sample_visible(const Double3& reference, Vec2 u) const {
  const Double3 w = center - reference;
  const double phi = 2 * kPiD * u.y, cos_phi = std::cos(phi), sin_phi = std::sin(phi);
  if (!sees_from_outside(reference)) {
    const double z = 1 - 2 * double(u.x), r = std::sqrt(std::max(0.0, 1 - z * z));
    const Double3 d(r * cos_phi, r * sin_phi, z);
    // The distance is the far root of the quadratic. For a reference point on the surface the near root is
    // the point itself, and so is the far root for a direction that points outward.
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
  // Cosine of the angle at the centre between the reference point and the visible point (Pharr, Jakob &
  // Humphreys 2023, section 6.2.4).
  const double cos_alpha =
      sin2 / std::sqrt(sin2_max) + cos_theta * std::sqrt(std::max(0.0, 1 - sin2 / sin2_max));
  const double sin_alpha = std::sqrt(std::max(0.0, 1 - cos_alpha * cos_alpha));
  const Double3 n = w * (-1 / std::sqrt(distance_squared));
  Double3 s, t;
  make_basis(n, s, t);
  return s * (sin_alpha * cos_phi) + t * (sin_alpha * sin_phi) + n * cos_alpha;
}

RTCGeometry make_sphere_geometry(RTCDevice device, const Ball& ball) {
  return make_user_geometry(device, ball);
}

}  // namespace aureole
