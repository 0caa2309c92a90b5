// SPDX-License-Identifier: Apache-2.0
// Half vectors (and directions) of the upper hemisphere as points of the unit square, by the map of J. Dupuy and W.
// Jakob, "An adaptive parameterization for efficient material acquisition and rendering", ACM TOG 37(6), 2018:
// u = sqrt(2 theta / pi), so that small angles have many nodes, and v = (phi + pi) / (2 pi).
#pragma once

#include <algorithm>
#include <cmath>

#include "aureole/bsdf/measured/four.h"
#include "aureole/math/warp.h"

namespace aureole {

/// The angles of four points (x, y) from the x axis, for y >= 0, in [0, pi]; errors below 3e-7 rad. The polynomial is
/// equation 4.4.49 of M. Abramowitz and I. A. Stegun, Handbook of Mathematical Functions, 1964. It takes a quarter of the
/// time of std::atan2.
inline Four angles_above_axis(Four y, Four x) {
  const Four ax = x < 0 ? -x : x, small = ax < y ? ax : y, large = ax < y ? y : ax;
  const Four t = small / (large > 0 ? large : 1 - Four{}), z = t * t, z2 = z * z, z4 = z2 * z2;
  const Four low = (1 - 0.3333314528f * z) + (0.1999355085f - 0.1420889944f * z) * z2;
  const Four high = (0.1065626393f - 0.0752896400f * z) + (0.0429096138f - 0.0161657367f * z) * z2;
  const Four first = t * (low + (high + 0.0028662257f * z4) * z4);
  const Four octant = y > ax ? 0.5f * kPi - first : first;
  return x < 0 ? kPi - octant : octant;
}

/// The angle of one point from the x axis, as of four.
inline float angle_above_axis(float y, float x) { return angles_above_axis(y - Four{}, x - Four{})[0]; }

/// The azimuth of a vector in [-pi, pi].
inline float azimuth_of(const Vec3& w) { return std::copysign(angle_above_axis(std::abs(w.y), w.x), w.y); }

/// Polar angle and azimuth of a vector, whose length does not matter.
struct Angles {
  float theta, phi;
};
inline Angles angles_of(const Vec3& w) {
  const Four angles =
      angles_above_axis(Four{std::sqrt(w.x * w.x + w.y * w.y), std::abs(w.y), 0, 0}, Four{w.z, w.x, 0, 0});
  return {angles[0], std::copysign(angles[1], w.y)};
}

/// The point of the square that has these angles; v is in [0, 1].
inline Vec2 square_of(const Angles& a) {
  return {std::sqrt(a.theta * (2 * kInvPi)), a.phi * (0.5f * kInvPi) + 0.5f};
}

/// Maps a vector to its point of the square.
inline Vec2 half_vector_to_square(const Vec3& m) { return square_of(angles_of(m)); }

/// The projection of a direction on the surface, from which isotropic tables count azimuths; the x axis for the normal.
inline Vec2 azimuth_axis(const Vec3& w) { return w.x * w.x + w.y * w.y > 0 ? Vec2{w.x, w.y} : Vec2{1, 0}; }

inline Vec3 square_to_half_vector(Vec2 p) {
  const float theta = p.x * p.x * (0.5f * kPi), sine = std::sin(theta);
  const Vec2 phi = cos_sin_2pi(p.y < 0.5f ? p.y + 0.5f : p.y - 0.5f);
  return {sine * phi.x, sine * phi.y, std::cos(theta)};
}

/// The solid angle of half vectors per area of the square, at the coordinate u and the sine of theta. It is bounded from
/// below, as in Mitsuba: at u = 0 all v are one half vector.
inline float half_vector_area(float u, float sine) { return std::max(2 * kPi * kPi * u * sine, 1e-6f); }

}  // namespace aureole
