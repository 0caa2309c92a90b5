// SPDX-License-Identifier: Apache-2.0
// Maps from the unit square to discs, spheres, cones and triangles, with the stated pdfs for uniform points.
// They use only polynomials and square roots, which are fast and give the same bits with every C library.
#pragma once

#include <algorithm>
#include <cmath>

#include "aureole/math/vec.h"

namespace aureole {

/// The largest float below one; it keeps mapped points inside the boundary of their domain.
inline constexpr float kOneMinusEpsilon = 0x1.fffffep-1f;

/// Reuses the random number that chose a branch: maps u < p, or u >= p, to [0, 1).
inline float remap_below(float u, float p) { return std::min(u / p, kOneMinusEpsilon); }
inline float remap_above(float u, float p) { return std::min((u - p) / (1 - p), kOneMinusEpsilon); }

namespace detail {
/// Returns (cos a, sin a) for |a| <= pi/4; errors below 1.2e-7 (the polynomials of S. Moshier's Cephes
/// library).
inline Vec2 cos_sin_quarter(float a) {
  const float a2 = a * a;
  const float c = 1 + a2 * (-0.5f + a2 * (4.166664568e-2f + a2 * (-1.388731625e-3f + a2 * 2.443315712e-5f)));
  const float s = a * (1 + a2 * (-1.666665461e-1f + a2 * (8.332160874e-3f + a2 * -1.951529589e-4f)));
  return {c, s};
}
}  // namespace detail

/// Returns (cos, sin) of 2 pi u for u in [0, 1].
inline Vec2 cos_sin_2pi(float u) {
  const int quadrant = int(4 * u + 0.5f);
  const Vec2 a = detail::cos_sin_quarter(2 * kPi * (u - 0.25f * float(quadrant)));
  switch (quadrant & 3) {
    case 0:
      return a;
    case 1:
      return {-a.y, a.x};
    case 2:
      return {-a.x, -a.y};
    default:
      return {a.y, -a.x};
  }
}

/// A point of the unit disc and its polar radius, which is free of rounding errors.
struct DiscPoint {
  Vec2 p;
  float radius = 0;
};

/// Maps to the unit disc, area-preserving and with low distortion (Shirley & Chiu 1997, "A low distortion map
/// between disk and square"). The radius stays below one.
inline DiscPoint square_to_disc_concentric(Vec2 u) {
  const float a = 2 * u.x - 1, b = 2 * u.y - 1;
  if (a == 0 && b == 0) return {};
  const bool x_major = std::abs(a) > std::abs(b);
  const float major = x_major ? a : b, minor = x_major ? b : a;
  const float r = std::copysign(std::min(std::abs(major), kOneMinusEpsilon), major);
  const Vec2 angle = detail::cos_sin_quarter(0.25f * kPi * (minor / major));
  const float along = r * angle.x, across = r * angle.y;
  return {x_major ? Vec2{along, across} : Vec2{across, along}, std::abs(r)};
}
inline float square_to_disc_pdf() { return kInvPi; }
/// The inverse of `square_to_disc_concentric`, for points of the unit disc.
inline Vec2 disc_to_square_concentric(Vec2 p) {
  const float radius = std::sqrt(p.x * p.x + p.y * p.y), ax = std::abs(p.x), ay = std::abs(p.y);
  if (!(radius > 0)) return {0.5f, 0.5f};
  const float major = ax > ay ? std::copysign(radius, p.x) : std::copysign(radius, p.y);
  const float minor = major * (4 * kInvPi) * std::atan(ax > ay ? p.y / p.x : p.x / p.y);
  const Vec2 s = ax > ay ? Vec2{major, minor} : Vec2{minor, major};
  return {0.5f * s.x + 0.5f, 0.5f * s.y + 0.5f};
}

/// Maps to the upper hemisphere with pdf cos(theta)/pi; z is always positive.
inline Vec3 square_to_cosine_hemisphere(Vec2 u) {
  const DiscPoint d = square_to_disc_concentric(u);
  return {d.p.x, d.p.y, std::sqrt((1 - d.radius) * (1 + d.radius))};
}
inline float cosine_hemisphere_pdf(float cos_theta) { return std::max(cos_theta, 0.f) * kInvPi; }

/// Maps to the unit sphere with pdf 1/(4 pi).
inline Vec3 square_to_uniform_sphere(Vec2 u) {
  const float z = 1 - 2 * u.x;
  const float r = 2 * std::sqrt(std::max(u.x * (1 - u.x), 0.f));
  const Vec2 a = cos_sin_2pi(u.y);
  return {r * a.x, r * a.y, z};
}
inline constexpr float uniform_sphere_pdf() { return 0.25f * kInvPi; }

/// Maps uniformly to the cone around +z of half-angle alpha, given by `one_minus_cos` = 1 - cos(alpha), which
/// keeps narrow cones exact.
inline Vec3 square_to_uniform_cone(Vec2 u, float one_minus_cos) {
  const float x = u.x * one_minus_cos;  // x is 1 - cos(theta)
  const float r = std::sqrt(std::max(x * (2 - x), 0.f));
  const Vec2 a = cos_sin_2pi(u.y);
  return {r * a.x, r * a.y, 1 - x};
}
inline float uniform_cone_pdf(float one_minus_cos) { return 1 / (2 * kPi * one_minus_cos); }

/// Maps to the upper hemisphere with pdf 1/(2 pi).
inline Vec3 square_to_uniform_hemisphere(Vec2 u) { return square_to_uniform_cone(u, 1); }
inline constexpr float uniform_hemisphere_pdf() { return 0.5f * kInvPi; }

/// Two barycentric coordinates, uniform over a triangle (Heitz 2019, "A low-distortion map between triangle
/// and square").
inline Vec2 square_to_triangle(Vec2 u) {
  if (u.y > u.x) return {0.5f * u.x, u.y - 0.5f * u.x};
  return {u.x - 0.5f * u.y, 0.5f * u.y};
}

}  // namespace aureole
