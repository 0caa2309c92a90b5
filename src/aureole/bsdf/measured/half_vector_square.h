// SPDX-License-Identifier: Apache-2.0
// Half vectors (and directions) of the upper hemisphere as points of the unit square, by the map of J. Dupuy and W.
// Jakob, "An adaptive parameterization for efficient material acquisition and rendering", ACM TOG 37(6), 2018:
// u = sqrt(2 theta / pi), so that small angles have many nodes, and v = (phi + pi) / (2 pi).
#pragma once

#include <algorithm>
#include <cmath>

#include "aureole/math/warp.h"

namespace aureole {

/// The angle of the point (x, y) from the x axis, for y >= 0, in [0, pi]; errors below 3e-7 rad. The polynomial is
/// equation 4.4.49 of M. Abramowitz and I. A. Stegun, Handbook of Mathematical Functions, 1964. It takes a quarter of the
/// time of std::atan2.
inline float angle_above_axis(float y, float x) {
  const float ax = std::abs(x), small = std::min(ax, y), large = std::max(ax, y);
  const float t = large > 0 ? small / large : 0.f, z = t * t, z2 = z * z, z4 = z2 * z2;
  const float low = (1 - 0.3333314528f * z) + (0.1999355085f - 0.1420889944f * z) * z2;
  const float high = (0.1065626393f - 0.0752896400f * z) + (0.0429096138f - 0.0161657367f * z) * z2;
  const float first = t * (low + (high + 0.0028662257f * z4) * z4);
  const float octant = y > ax ? 0.5f * kPi - first : first;
  return x < 0 ? kPi - octant : octant;
}

/// The azimuth of a vector in [-pi, pi].
inline float azimuth_of(const Vec3& w) { return std::copysign(angle_above_axis(std::abs(w.y), w.x), w.y); }

/// The angle of a vector from the z axis.
inline float polar_angle(const Vec3& w) { return angle_above_axis(std::sqrt(w.x * w.x + w.y * w.y), w.z); }

/// Maps a unit vector to its point of the square; v is in [0, 1].
inline Vec2 half_vector_to_square(const Vec3& m) {
  return {std::sqrt(polar_angle(m) * (2 * kInvPi)), azimuth_of(m) * (0.5f * kInvPi) + 0.5f};
}

inline Vec3 square_to_half_vector(Vec2 p) {
  const float theta = p.x * p.x * (0.5f * kPi), sine = std::sin(theta);
  const Vec2 phi = cos_sin_2pi(p.y < 0.5f ? p.y + 0.5f : p.y - 0.5f);
  return {sine * phi.x, sine * phi.y, std::cos(theta)};
}

/// The solid angle of half vectors per area of the square, at the coordinate u and the sine of theta. It is bounded from
/// below, as in Mitsuba: at u = 0 all v are one half vector.
inline float half_vector_area(float u, float sine) { return std::max(2 * kPi * kPi * u * sine, 1e-6f); }

}  // namespace aureole
