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

Instance::Instance(std::shared_ptr<const ShapeList> list, const Bounds3& bounds, const Motion& motion,
                   const Transform& to_outer, const Properties& properties)
    : list_(std::move(list)), bounds_(bounds) {
  for (const KeyFrame& frame : motion.frames()) {
    maps_.to_world = rounded(frame.transform * to_outer);
    if (!invert(maps_)) throw properties.error("to_world", "leaves the range of single precision");
  }
  if (!motion.is_moving()) return;
  maps_.to_world = rounded(motion.first() * to_outer);
  invert(maps_);
  path_ = std::make_shared<const Path>(Path{motion, to_outer, {}, {maps_.to_world, maps_.to_world}});
}

Instance::Rows Instance::rounded(const Transform& transform) {
  Rows rows;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 4; ++k) rows[i][k] = float(transform.matrix()[i][k]);
  return rows;
}

bool Instance::invert(Maps& maps) {
  const Rows& to_world = maps.to_world;
  Double3 column[3];
  for (int k = 0; k < 3; ++k) column[k] = {to_world[0][k], to_world[1][k], to_world[2][k]};
  const Double3 origin(to_world[0][3], to_world[1][3], to_world[2][3]);

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
      maps.to_group[i][k] = float(element(row, k));
      // Accounts for the transform of a ray's origin with these values, and its rounding.
      error[i][k] = element(in_row, k) + gamma_bound(4) * std::abs(element(row, k));
    }
    maps.to_group[i][3] = float(offset);
    error[i][3] = in_offset + gamma_bound(4) * std::abs(offset);
  }
  bool is_good = true;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 4; ++k) {
      double sum = 0;
      for (int j = 0; j < 3; ++j) sum += std::abs(to_world[i][j]) * error[j][k];
      maps.error[i][k] = float(sum);
      const float size = std::abs(maps.to_group[i][k]);
      is_good &= std::isfinite(to_world[i][k]) && size < 1e18f && std::isfinite(maps.error[i][k]);
    }
  return is_good;
}

bool Instance::is_in_same_place(const Instance& other) const {
  if (!(maps_.to_world == other.maps_.to_world) || is_moving() != other.is_moving()) return false;
  if (!is_moving()) return true;
  const TimeWindow &a = path_->window, &b = other.path_->window;
  return a.start == b.start && a.scale == b.scale && path_->steps == other.path_->steps;
}

std::shared_ptr<const Instance> Instance::during(double open, double close) const {
  constexpr std::size_t kMostSegments = 128;  // one less than Embree's limit of time steps
  constexpr double kTolerance = 1e-5;         // of the instance's size
  auto moved = std::make_shared<Instance>(*this);
  Path path{path_->motion, path_->to_outer, {}, {}};
  path.window = {true, float(open), close > open ? float(1 / (close - open)) : 0.f};
  const auto at = [&](double fraction) {
    return path.motion.at(open + fraction * (close - open)) * path.to_outer;
  };
  std::array<Vec3, 8> corners;
  for (std::size_t c = 0; c < corners.size() && !bounds_.empty(); ++c)
    corners[c] = {c & 1 ? bounds_.upper.x : bounds_.lower.x, c & 2 ? bounds_.upper.y : bounds_.lower.y,
                  c & 4 ? bounds_.upper.z : bounds_.lower.z};
  for (std::size_t segments = 1;; segments *= 2) {
    path.steps.clear();
    for (std::size_t k = 0; k <= segments; ++k)
      path.steps.push_back(rounded(at(double(k) / double(segments))));
    path.deviation = 0;
    // Odd numbers of points within a segment, so that a motion by whole turns between the steps is not missed.
    constexpr int kWithin = 7;
    for (std::size_t k = 0; k < segments; ++k)
      for (int i = 1; i <= kWithin; ++i) {
        const double f = double(i) / (kWithin + 1);
        const Transform exact = at((double(k) + f) / double(segments));
        const Transform before = affine(path.steps[k]), after = affine(path.steps[k + 1]);
        for (const Vec3& corner : corners) {
          const Vec3 p = before.point(corner) * float(1 - f) + after.point(corner) * float(f);
          path.deviation = std::max(path.deviation, double(length(exact.point(corner) - p)));
        }
      }
    const double size = double(length(bounds_by(path.steps.front()).diagonal()));
    if (segments == kMostSegments || path.deviation <= kTolerance * size) break;
  }
  moved->maps_.to_world = path.steps.front();
  invert(moved->maps_);
  moved->path_ = std::make_shared<const Path>(std::move(path));
  return moved;
}

Instance::Maps Instance::maps_at(float time) const {
  // As Embree interpolates, in single precision.
  const std::vector<Rows>& steps = path_->steps;
  const float place = path_->window.fraction(time) * float(steps.size() - 1);
  const std::size_t k = std::min(std::size_t(place), steps.size() - 2);
  const float f = place - float(k);
  Maps maps;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 4; ++j)
      maps.to_world[i][j] = (1 - f) * steps[k][i][j] + f * steps[k + 1][i][j];
  invert(maps);
  // The ray tracer's own interpolation may round otherwise: by three roundings of each product, and of the place
  // between the steps.
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 4; ++j)
      maps.error[i][j] +=
          gamma_bound(6) * (std::abs(steps[k][i][j]) + std::abs(steps[k + 1][i][j])) +
          gamma_bound(4) * float(steps.size()) * std::abs(steps[k + 1][i][j] - steps[k][i][j]);
  return maps;
}

RTCGeometry Instance::make_geometry(RTCDevice device, RTCScene scene) const {
  RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(g, scene);
  if (path_) {
    rtcSetGeometryTimeStepCount(g, unsigned(path_->steps.size()));
    for (std::size_t k = 0; k < path_->steps.size(); ++k)
      rtcSetGeometryTransform(g, unsigned(k), RTC_FORMAT_FLOAT3X4_ROW_MAJOR, path_->steps[k].data());
  } else {
    rtcSetGeometryTransform(g, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, maps_.to_world.data());
  }
  rtcCommitGeometry(g);
  return g;
}

Vec3 Instance::point_to_world(const Vec3& p) const {
  const Rows& m = maps_.to_world;
  return linear(m, p) + Vec3{m[0][3], m[1][3], m[2][3]};
}

Vec3 Instance::point_to_group(const Vec3& p, const Maps& maps) {
  const Rows& m = maps.to_group;
  return linear(m, p) + Vec3{m[0][3], m[1][3], m[2][3]};
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
  if (!path_) return surface_point(shape, hit, ray, tangent, maps_);
  SurfacePoint s = surface_point(shape, hit, ray, tangent, maps_at(ray.time));
  s.time = ray.time;
  return s;
}

SurfacePoint Instance::surface_point(const Shape& shape, const ShapeHit& hit, const Ray& ray, bool tangent,
                                     const Maps& maps) const {
  const Vec3 offset{maps.to_group[0][3], maps.to_group[1][3], maps.to_group[2][3]};
  SurfacePoint s = shape.surface_point(
      hit, {linear(maps.to_group, ray.o) + offset, linear(maps.to_group, ray.d)}, tangent);
  const Vec3 in_group = s.p, group_error = s.p_error;
  for (int i = 0; i < 3; ++i) {
    const auto& m = maps.to_world[i];
    s.p[i] = float(double(m[0]) * in_group.x + double(m[1]) * in_group.y + double(m[2]) * in_group.z + m[3]);
  }
  const Vec3 size = abs(s.p);
  for (int i = 0; i < 3; ++i) {
    const auto &m = maps.to_world[i], &e = maps.error[i];
    s.p_error[i] = std::abs(m[0]) * group_error.x + std::abs(m[1]) * group_error.y +
                   std::abs(m[2]) * group_error.z + gamma_bound(2) * size[i] +
                   (e[0] * size.x + e[1] * size.y + e[2] * size.z + e[3]);
  }
  s.ng = normalize(transposed(maps.to_group, s.ng));
  const Vec3 n = normalize(transposed(maps.to_group, s.shading.n));
  // The frame's tangent was made perpendicular to the normal, which the map does not preserve, so it is
  // recomputed.
  s.shading = tangent ? Frame::from_normal_tangent(n, linear(maps.to_world, shape.own_derivatives(s).dp_du))
                      : Frame::from_normal(n);
  s.instance = this;
  return s;
}

SurfaceDerivatives Instance::to_world(const SurfaceDerivatives& d, float time) const {
  const Rows& m = path_ ? maps_at(time).to_world : maps_.to_world;
  return {linear(m, d.dp_du), linear(m, d.dp_dv)};
}

float Instance::farthest(float limit) const {
  float least = farthest(limit, maps_);
  if (path_)
    for (const Rows& step : path_->steps) {
      Maps maps;
      maps.to_world = step;
      // Between two steps, which differ little, the instance is at most half as large.
      constexpr float kBetween = 0.5f;
      least = std::min(least, invert(maps) ? kBetween * farthest(limit, maps) : 0.f);
    }
  return least;
}

float Instance::farthest(float limit, const Maps& maps) {
  double least = limit;
  for (const auto& row : maps.to_group) {
    const double size = std::abs(double(row[0])) + std::abs(double(row[1])) + std::abs(double(row[2]));
    least = std::min(least, (double(limit) - std::abs(double(row[3]))) / size);
  }
  // the factor is a margin for the rounding of the transformed ray
  return float(std::max(least, 0.0) * (1 - 1e-6));
}

Bounds3 Instance::bounds() const {
  Bounds3 all = bounds_by(maps_.to_world);
  if (path_)
    for (const Rows& step : path_->steps) all.extend(bounds_by(step));
  return all;
}

Bounds3 Instance::bounds_by(const Rows& to_world) const {
  const Bounds3& b = bounds_;
  Bounds3 all;
  for (int corner = 0; corner < 8 && !b.empty(); ++corner) {
    Vec3 p;
    for (int i = 0; i < 3; ++i) {
      const auto& m = to_world[i];
      p[i] = float(double(m[0]) * (corner & 1 ? b.upper : b.lower).x +
                   double(m[1]) * (corner & 2 ? b.upper : b.lower).y +
                   double(m[2]) * (corner & 4 ? b.upper : b.lower).z + m[3]);
    }
    all.extend(p);
  }
  return all;
}

}  // namespace aureole
