// SPDX-License-Identifier: Apache-2.0
// A sphere with Mitsuba 3's conventions: normals point outward; `flip_normals` and a mirroring `to_world`
// each reverse them (a negative radius, which has that effect in Mitsuba, is an error). u is the azimuth
// about the sphere's local z axis, v runs from its north pole.
#include <algorithm>
#include <utility>

#include "aureole/math/warp.h"
#include "aureole/plugin/registry.h"
#include "aureole/shape/geometry/double3.h"
#include "aureole/shape/geometry/outline.h"
#include "aureole/shape/geometry/sphere_geometry.h"
#include "aureole/shape/shape.h"

namespace aureole {
namespace {

class Sphere;

class SphereSampler final : public AreaSampler {
public:
  explicit SphereSampler(const Sphere& sphere);

  float patch_area(std::size_t) const override { return float(4 * kPiD * ball_.radius * ball_.radius); }
  Bounds3 patch_bounds(std::size_t) const override { return ball_.bounds(); }
  std::pair<Vec3, float> patch_normals(std::size_t) const override { return {{0, 0, 1}, -1.f}; }
  std::optional<ShapeSample> sample_direct(const Vec3& reference, std::size_t, Vec2 u) const override;
  PositionSample sample_direct_position(const Vec3& reference, std::size_t, Vec2 u) const override;
  std::optional<ShapeSample> sample_area(std::size_t, Vec2 u) const override;
  float pdf_direct(const Vec3& reference, std::size_t, const SurfacePoint&) const override;
  std::optional<ShapeSample> point_at_uv(Vec2 uv) const override;

private:
  const Sphere& sphere_;
  const Ball& ball_;
};

class Sphere final : public Shape, public RoundShape {
public:
  explicit Sphere(const Properties& properties);

  RTCGeometry make_geometry(RTCDevice device) const override { return make_sphere_geometry(device, ball_); }
  SurfacePoint surface_point(const ShapeHit& hit, const Ray& ray, bool) const override {
    return point_in_direction(Double3(ray.o) + Double3(ray.d) * double(hit.t) - ball_.center);
  }
  Bounds3 bounds() const override { return ball_.bounds(); }
  std::size_t primitive_count() const override { return 1; }

  SurfaceDerivatives own_derivatives(const SurfacePoint& point) const override;
  std::shared_ptr<const AreaSampler> make_area_sampler(AreaUse) const override {
    return std::make_shared<const SphereSampler>(*this);
  }

  double round_radius() const override { return ball_.radius; }
  bool is_curved() const override { return true; }
  std::optional<Double3> ball_center() const override { return ball_.center; }
  bool is_hollow() const override { return inward_; }
  double edge_count(int pieces) const override { return 0.75 * pieces * pieces; }
  OutlineMesh outline_mesh(int pieces) const override;

  const Ball& ball() const { return ball_; }
  /// Returns the surface point in the direction `out`, of any length, from the centre.
  SurfacePoint point_in_direction(const Double3& out) const;
  /// Returns the surface point with these texture coordinates.
  SurfacePoint point_at_uv(Vec2 uv) const {
    const double phi = 2 * kPiD * uv.x, theta = kPiD * uv.y, across = std::sin(theta);
    return point_in_direction(axis_[0] * (across * std::cos(phi)) + axis_[1] * (across * std::sin(phi)) +
                              axis_[2] * std::cos(theta));
  }
  /// Sets the position, error bound and geometric normal of a point; returns the outward normal.
  template <class Point>
  Double3 set_position(Point& s, const Double3& out) const;

private:
  Ball ball_;
  Double3 axis_[3];  ///< axes of the local coordinates, unit length
  bool inward_ = false;
};

Sphere::Sphere(const Properties& properties) : Shape(properties) {
  const Transform to_world = properties.get_transform("to_world");
  const Vec3 center = properties.get_vec3("center", {0, 0, 0});
  const double radius = properties.get_float("radius", 1.0, Range::positive());
  inward_ = properties.get_bool("flip_normals", false);

  const auto& m = to_world.matrix();
  double scale[3];
  for (int k = 0; k < 3; ++k) {
    const Double3 column(m[0][k], m[1][k], m[2][k]);
    scale[k] = length(column);
    axis_[k] = column * (1 / scale[k]);
  }
  const double skew = std::max({std::abs(dot(axis_[0], axis_[1])), std::abs(dot(axis_[1], axis_[2])),
                                std::abs(dot(axis_[2], axis_[0]))});
  const auto [least, most] = std::minmax({scale[0], scale[1], scale[2]});
  if (skew > 1e-4 || most - least > 1e-4 * most)
    throw properties.error("to_world",
                           "a sphere stays one only under rotation, uniform scaling and translation");
  if (dot(cross(axis_[0], axis_[1]), axis_[2]) < 0) inward_ = !inward_;

  for (int i = 0; i < 3; ++i) {
    const double c = m[i][0] * center.x + m[i][1] * center.y + m[i][2] * center.z + m[i][3];
    (i == 0 ? ball_.center.x : i == 1 ? ball_.center.y : ball_.center.z) = c;
  }
  ball_.inward = inward_;
  ball_.radius = radius * (scale[0] + scale[1] + scale[2]) / 3;
}

SurfacePoint Sphere::point_in_direction(const Double3& out) const {
  SurfacePoint s;
  const Double3 n = set_position(s, out);

  const double x = dot(n, axis_[0]), y = dot(n, axis_[1]), z = dot(n, axis_[2]);
  double phi = std::atan2(y, x);
  if (phi < 0) phi += 2 * kPiD;
  s.uv = {float(phi / (2 * kPiD)), float(std::atan2(std::hypot(x, y), z) / kPiD)};
  s.shading = Frame::from_normal_tangent(s.ng, (axis_[1] * x - axis_[0] * y).to_float());
  s.shape = this;
  return s;
}

/// Makes an octahedron whose faces are subdivided into rows and projected onto the sphere.
OutlineMesh Sphere::outline_mesh(int pieces) const {
  const int rows = std::max(1, pieces / 4);
  OutlineMesh mesh;
  std::vector<Double3> out;
  const auto side = [&](double sx, double sy, double sz) {
    const auto first = std::uint32_t(out.size());
    const auto index = [&](int i, int j) {
      return first + std::uint32_t(i * (rows + 1) - i * (i - 1) / 2 + j);
    };
    for (int i = 0; i <= rows; ++i)
      for (int j = 0; j <= rows - i; ++j)
        out.push_back(normalize(Double3{sx * i, sy * j, sz * (rows - i - j)}));
    for (int i = 0; i < rows; ++i)
      for (int j = 0; j < rows - i; ++j) {
        mesh.triangles.push_back({index(i, j), index(i + 1, j), index(i, j + 1)});
        if (i + j < rows - 1)
          mesh.triangles.push_back({index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)});
      }
  };
  for (int octant = 0; octant < 8; ++octant)
    side(octant & 1 ? -1 : 1, octant & 2 ? -1 : 1, octant & 4 ? -1 : 1);
  // Scale by which the middle of the longest edge touches the sphere.
  double least = 1;
  for (const TriangleIndices& t : mesh.triangles)
    for (std::size_t c = 0; c < 3; ++c)
      least = std::min(least, 0.5 * length(out[t[c]] + out[t[(c + 1) % 3]]));
  for (const Double3& d : out) mesh.add(ball_.center + d * (ball_.radius / least));
  return mesh;
}

template <class Point>
Double3 Sphere::set_position(Point& s, const Double3& out) const {
  const double l = length(out);
  const Double3 n = l > 0 ? out * (1 / l) : axis_[2];
  s.p = (ball_.center + n * ball_.radius).to_float();
  // The point is computed in double precision, so nearly all the error comes from rounding the result.
  // gamma(5) |p| is the bound of Pharr, Jakob & Humphreys 2023, section 6.8.5, for a point projected in
  // float.
  s.ng = (inward_ ? -n : n).to_float();
  // For a sphere much larger than the scene that it touches, the double arithmetic itself, here and in a
  // later ray's intersection, errs by more.
  const double in_double = 16 * 0x1p-53 * (ball_.radius + length(ball_.center));
  s.p_error = abs(s.p) * gamma_bound(5) + abs(s.ng) * float(in_double);
  return n;
}

SphereSampler::SphereSampler(const Sphere& sphere) : sphere_(sphere), ball_(sphere.ball()) {}

PositionSample SphereSampler::sample_direct_position(const Vec3& reference, std::size_t, Vec2 u) const {
  PositionSample s;
  if (const auto out = ball_.sample_visible(Double3(reference), u)) {
    sphere_.set_position(s, *out);
    s.pdf = ball_.visible_pdf(Double3(reference));
  }
  return s;
}

SurfaceDerivatives Sphere::own_derivatives(const SurfacePoint& point) const {
  // Texture coordinates: u = phi / 2 pi about the third axis, v = theta / pi from that axis.
  const double phi = 2 * kPiD * point.uv.x, theta = kPiD * point.uv.y;
  const Double3 along = axis_[0] * std::cos(phi) + axis_[1] * std::sin(phi);
  const Double3 across = axis_[1] * std::cos(phi) - axis_[0] * std::sin(phi);
  const Double3 by_theta = along * std::cos(theta) - axis_[2] * std::sin(theta);
  return {(across * (2 * kPiD * ball_.radius * std::sin(theta))).to_float(),
          (by_theta * (kPiD * ball_.radius)).to_float()};
}

std::optional<ShapeSample> SphereSampler::sample_direct(const Vec3& reference, std::size_t, Vec2 u) const {
  const auto out = ball_.sample_visible(Double3(reference), u);
  if (!out) return std::nullopt;
  const SurfacePoint s = sphere_.point_in_direction(*out);
  return ShapeSample{s.p, s.p_error, s.ng, s.uv, ball_.visible_pdf(Double3(reference))};
}

std::optional<ShapeSample> SphereSampler::sample_area(std::size_t, Vec2 u) const {
  const SurfacePoint s = sphere_.point_in_direction(Double3(square_to_uniform_sphere(u)));
  return ShapeSample{s.p, s.p_error, s.ng, s.uv, 1 / patch_area(0)};
}

std::optional<ShapeSample> SphereSampler::point_at_uv(Vec2 uv) const {
  const SurfacePoint s = sphere_.point_at_uv(uv);
  const double r = ball_.radius, area_per_uv = 2 * kPiD * kPiD * r * r * std::sin(kPiD * uv.y);
  return ShapeSample{s.p, s.p_error, s.ng, uv, float(1 / std::max(area_per_uv, 0.0))};
}

float SphereSampler::pdf_direct(const Vec3& reference, std::size_t, const SurfacePoint& point) const {
  const Double3 from(reference);
  if (!ball_.sees_from_outside(from) && ball_.is_self(from, length(point.p - reference))) return 0;
  return ball_.visible_pdf(from);
}

AUREOLE_PLUGIN(Sphere, "shape", "sphere",
               PluginDoc{
                   .summary = "An exact sphere. As an emitter it is sampled uniformly over the cone of "
                              "directions in which it is visible from outside, and over all directions from "
                              "inside.",
                   .source = "Pharr, Jakob & Humphreys 2023, \"Physically Based Rendering\", sections "
                             "6.2.4 and 6.8.5; quadratic of "
                             "Haines, Guenther & Akenine-Moeller 2019, \"Precision improvements for "
                             "ray/sphere intersection\".",
                   .parameters = {{"center", "vector", "scene units", "0, 0, 0", "centre, before to_world"},
                                  {"radius", "float", "scene units", "1", "radius, before to_world"}},
                   .examples = {R"(<shape type="sphere">
  <point name="center" x="1" y="0" z="0"/>
  <float name="radius" value="2"/>
  <boolean name="flip_normals" value="false"/>
  <transform name="to_world"><rotate z="1" angle="30"/></transform>
  <bsdf type="diffuse"/>
  <emitter type="area"><float name="radiance" value="1"/></emitter>
</shape>)"}});

}  // namespace
}  // namespace aureole
