// SPDX-License-Identifier: Apache-2.0
// Two- and three-component float vectors. Points, directions and normals have one type; variable names
// distinguish them.
#pragma once

#include <algorithm>
#include <cmath>

namespace aureole {

inline constexpr float kPi = 3.14159265358979323846f;
inline constexpr double kPiD = 3.14159265358979323846;
inline constexpr double kDegree = kPiD / 180;  ///< one degree [rad]
inline constexpr float kInvPi = 0.31830988618379067154f;
inline constexpr float kInfinity = 3.4e38f;

struct Vec2 {
  float x = 0, y = 0;
};
inline Vec2 operator+(Vec2 a, Vec2 b) { return {a.x + b.x, a.y + b.y}; }
inline Vec2 operator-(Vec2 a, Vec2 b) { return {a.x - b.x, a.y - b.y}; }
inline Vec2 operator*(Vec2 a, float s) { return {a.x * s, a.y * s}; }
inline Vec2 operator*(float s, Vec2 a) { return a * s; }

struct Vec3 {
  float x = 0, y = 0, z = 0;
  float& operator[](int i) { return (&x)[i]; }
  float operator[](int i) const { return (&x)[i]; }
  Vec3& operator+=(const Vec3& b) { return x += b.x, y += b.y, z += b.z, *this; }
};
inline Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
inline Vec3 operator*(const Vec3& a, float s) { return {a.x * s, a.y * s, a.z * s}; }
inline Vec3 operator*(float s, const Vec3& a) { return a * s; }
inline Vec3 operator*(const Vec3& a, const Vec3& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
inline Vec3 operator/(const Vec3& a, float s) { return a * (1.f / s); }
inline bool operator==(const Vec3& a, const Vec3& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

inline float dot(Vec2 a, Vec2 b) { return a.x * b.x + a.y * b.y; }
inline float dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline float length_squared(const Vec3& a) { return dot(a, a); }
inline float length(const Vec3& a) { return std::sqrt(dot(a, a)); }
inline Vec3 normalize(const Vec3& a) { return a * (1.f / length(a)); }
inline Vec3 abs(const Vec3& a) { return {std::abs(a.x), std::abs(a.y), std::abs(a.z)}; }
inline Vec3 min(const Vec3& a, const Vec3& b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
inline Vec3 max(const Vec3& a, const Vec3& b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}
inline float max_component(const Vec3& a) { return std::max({a.x, a.y, a.z}); }
inline bool is_finite(const Vec3& a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

/// Axis-aligned box, initially empty.
struct Bounds3 {
  Vec3 lower{kInfinity, kInfinity, kInfinity};
  Vec3 upper{-kInfinity, -kInfinity, -kInfinity};
  void extend(const Vec3& p) { lower = min(lower, p), upper = max(upper, p); }
  void extend(const Bounds3& b) { lower = min(lower, b.lower), upper = max(upper, b.upper); }
  bool empty() const { return lower.x > upper.x; }
  Vec3 center() const { return 0.5f * (lower + upper); }
  Vec3 diagonal() const { return upper - lower; }
};
/// The squared distance of two boxes; 0 if they overlap.
inline float squared_distance(const Bounds3& a, const Bounds3& b) {
  return length_squared(max(max(a.lower - b.upper, b.lower - a.upper), Vec3{}));
}

/// A right-handed orthonormal frame; local z is `n`.
struct Frame {
  Vec3 s{1, 0, 0}, t{0, 1, 0}, n{0, 0, 1};

  /// Returns some frame around a unit normal (Duff et al. 2017, "Building an orthonormal basis, revisited").
  static Frame from_normal(const Vec3& n) {
    const float sign = std::copysign(1.f, n.z);
    const float a = -1.f / (sign + n.z);
    const float b = n.x * n.y * a;
    return {{1.f + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
  }
  /// The frame around `n` whose s is `tangent` made perpendicular to n; if that is degenerate, some frame
  /// around n.
  static Frame from_normal_tangent(const Vec3& n, const Vec3& tangent) {
    const Vec3 s = tangent - n * dot(n, tangent);
    const float l2 = length_squared(s);
    if (!(l2 > 1e-12f * length_squared(tangent)) || !std::isfinite(l2)) return from_normal(n);
    const Vec3 unit = s * (1.f / std::sqrt(l2));
    return {unit, cross(n, unit), n};
  }
  Vec3 to_local(const Vec3& v) const { return {dot(v, s), dot(v, t), dot(v, n)}; }
  Vec3 to_world(const Vec3& v) const { return s * v.x + t * v.y + n * v.z; }
};

/// A ray from `o` along `d` (of unit length unless stated otherwise), valid for distances in (0, t_max).
struct Ray {
  Vec3 o, d;
  float t_max = kInfinity;
  float time = 0;  ///< [s], for shapes that move
};

}  // namespace aureole
