// SPDX-License-Identifier: Apache-2.0
#include "aureole/shape/instance.h"

#include <cmath>

#include "aureole/plugin/properties.h"
#include "aureole/shape/geometry/double3.h"
#include "aureole/shape/shape.h"

namespace aureole {

namespace {

double element(const Double3& v, int i) { return i == 0 ? v.x : i == 1 ? v.y : v.z; }

template <class Rows>
Vec3 linear(const Rows& m, const Vec3& v) {
  return {m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z, m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
          m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z};
}

/// Applies the transpose of m. With the inverse transform it maps normals, which stay on their side even
/// under mirroring.
template <class Rows>
Vec3 transposed(const Rows& m, const Vec3& v) {
  return {m[0][0] * v.x + m[1][0] * v.y + m[2][0] * v.z, m[0][1] * v.x + m[1][1] * v.y + m[2][1] * v.z,
          m[0][2] * v.x + m[1][2] * v.y + m[2][2] * v.z};
}

}  // namespace

Instance::Instance(std::shared_ptr<const ShapeList> list, const Bounds3& bounds, const Transform& to_world,
                   const Properties& properties)
    : list_(std::move(list)), bounds_(bounds) {
  Double3 column[3];
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 4; ++k) to_world_[i][k] = float(to_world.matrix()[i][k]);
  for (int k = 0; k < 3; ++k) column[k] = {to_world_[0][k], to_world_[1][k], to_world_[2][k]};
  const Double3 origin(to_world_[0][3], to_world_[1][3], to_world_[2][3]);

  // The inverse by cofactors in single precision, as the ray caster computes it. Sums of absolute values give
  // bounds of its error.
  const auto absolute_cross = [](const Double3& a, const Double3& b) {
    return Double3{std::abs(a.y * b.z) + std::abs(a.z * b.y), std::abs(a.z * b.x) + std::abs(a.x * b.z),
                   std::abs(a.x * b.y) + std::abs(a.y * b.x)};
  };
  const auto absolute = [](const Double3& a) { return Double3{std::abs(a.x), std::abs(a.y), std::abs(a.z)}; };
  const double determinant = dot(column[0], cross(column[1], column[2]));
  const double absolute_determinant = dot(absolute(column[0]), absolute_cross(column[1], column[2]));
  const double in_determinant = gamma_bound(8) * absolute_determinant / std::abs(determinant);
  double error[3][4];
  for (int i = 0; i < 3; ++i) {
    const Double3 &a = column[(i + 1) % 3], &b = column[(i + 2) % 3];
    const Double3 row = cross(a, b) * (1 / determinant);
    const Double3 in_row = absolute_cross(a, b) * (gamma_bound(4) / std::abs(determinant)) +
                           absolute(row) * (in_determinant + gamma_bound(4));
    const double offset = -dot(row, origin);
    const double in_offset =
        dot(in_row, absolute(origin)) + gamma_bound(4) * dot(absolute(row), absolute(origin));
    for (int k = 0; k < 3; ++k) {
      to_group_[i][k] = float(element(row, k));
      // Accounts for the transform of a ray's origin with these values, and its rounding.
      error[i][k] = element(in_row, k) + gamma_bound(4) * std::abs(element(row, k));
    }
    to_group_[i][3] = float(offset);
    error[i][3] = in_offset + gamma_bound(4) * std::abs(offset);
  }
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 4; ++k) {
      double sum = 0;
      for (int j = 0; j < 3; ++j) sum += std::abs(to_world_[i][j]) * error[j][k];
      error_[i][k] = float(sum);
      const float size = std::abs(to_group_[i][k]);
      if (!std::isfinite(to_world_[i][k]) || !(size < 1e18f) || !std::isfinite(error_[i][k]))
        throw properties.error("to_world", "leaves the range of single precision");
    }
}

RTCGeometry Instance::make_geometry(RTCDevice device, RTCScene scene) const {
  RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(g, scene);
  rtcSetGeometryTransform(g, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, to_world_.data());
  rtcCommitGeometry(g);
  return g;
}

Vec3 Instance::point_to_world(const Vec3& p) const {
  return linear(to_world_, p) + Vec3{to_world_[0][3], to_world_[1][3], to_world_[2][3]};
}

Vec3 Instance::point_to_group(const Vec3& p) const {
  return linear(to_group_, p) + Vec3{to_group_[0][3], to_group_[1][3], to_group_[2][3]};
}

Transform Instance::affine(const Rows& rows) {
  Transform::Matrix m{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 4; ++k) m[i][k] = double(rows[i][k]);
  m[3][3] = 1;
  return Transform(m);
}

SurfacePoint Instance::surface_point(const Shape& shape, const ShapeHit& hit, const Ray& ray,
                                     bool tangent) const {
  const Vec3 offset{to_group_[0][3], to_group_[1][3], to_group_[2][3]};
  SurfacePoint s =
      shape.surface_point(hit, {linear(to_group_, ray.o) + offset, linear(to_group_, ray.d)}, tangent);
  const Vec3 in_group = s.p, group_error = s.p_error;
  for (int i = 0; i < 3; ++i) {
    const auto& m = to_world_[i];
    s.p[i] = float(double(m[0]) * in_group.x + double(m[1]) * in_group.y + double(m[2]) * in_group.z + m[3]);
  }
  const Vec3 size = abs(s.p);
  for (int i = 0; i < 3; ++i) {
    const auto &m = to_world_[i], &e = error_[i];
    s.p_error[i] = std::abs(m[0]) * group_error.x + std::abs(m[1]) * group_error.y +
                   std::abs(m[2]) * group_error.z + gamma_bound(2) * size[i] +
                   (e[0] * size.x + e[1] * size.y + e[2] * size.z + e[3]);
  }
  s.ng = normalize(transposed(to_group_, s.ng));
  const Vec3 n = normalize(transposed(to_group_, s.shading.n));
  // The frame is recomputed: its tangent was made perpendicular to the normal, which the map does not
  // preserve.
  s.shading = tangent ? Frame::from_normal_tangent(n, linear(to_world_, shape.own_derivatives(s).dp_du))
                      : Frame::from_normal(n);
  s.instance = this;
  return s;
}

SurfaceDerivatives Instance::to_world(const SurfaceDerivatives& d) const {
  return {linear(to_world_, d.dp_du), linear(to_world_, d.dp_dv)};
}

float Instance::farthest(float limit) const {
  double least = limit;
  for (const auto& row : to_group_) {
    const double size = std::abs(double(row[0])) + std::abs(double(row[1])) + std::abs(double(row[2]));
    least = std::min(least, (double(limit) - std::abs(double(row[3]))) / size);
  }
  // the factor is a margin for the rounding of the transformed ray
  return float(std::max(least, 0.0) * (1 - 1e-6));
}

Bounds3 Instance::bounds() const {
  const Bounds3& b = bounds_;
  Bounds3 all;
  for (int corner = 0; corner < 8 && !b.empty(); ++corner) {
    Vec3 p;
    for (int i = 0; i < 3; ++i) {
      const auto& m = to_world_[i];
      p[i] = float(double(m[0]) * (corner & 1 ? b.upper : b.lower).x +
                   double(m[1]) * (corner & 2 ? b.upper : b.lower).y +
                   double(m[2]) * (corner & 4 ? b.upper : b.lower).z + m[3]);
    }
    all.extend(p);
  }
  return all;
}

}  // namespace aureole
