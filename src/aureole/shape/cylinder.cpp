// SPDX-License-Identifier: Apache-2.0
// An open cylinder with Mitsuba 3's conventions: u is the azimuth, v runs along the axis from p0 to p1.
// Normals point outward, also under a mirroring to_world; `flip_normals` reverses them. Any affine to_world
// is exact: the surface may become an elliptic or an oblique cylinder.
#include <algorithm>

#include "aureole/plugin/registry.h"
#include "aureole/shape/geometry/outline.h"
#include "aureole/shape/geometry/shape_placement.h"
#include "aureole/shape/geometry/user_geometry.h"
#include "aureole/shape/sampling/cylinder_sampling.h"
#include "aureole/shape/sampling/spherical_sampling.h"
#include "aureole/shape/shape.h"

namespace aureole {
namespace {

/// The image of the cylinder x^2 + y^2 = 1, z in [0, 1], under a placement.
struct PlacedCylinder {
  Placement place;

  Bounds3 bounds() const {
    const Double3 &u = place.axis(0), &v = place.axis(1), &w = place.axis(2);
    const Double3 reach(std::hypot(u.x, v.x), std::hypot(u.y, v.y), std::hypot(u.z, v.z));
    Bounds3 b = outward_bounds(place.origin() - reach, place.origin() + reach);
    b.extend(outward_bounds(place.origin() + w - reach, place.origin() + w + reach));
    return b;
  }
  std::optional<double> intersect(const Double3& o, const Double3& d, double t_min, double t_max) const {
    const Double3 from = place.local_point(o), along = place.local_vector(d);
    const double a = along.x * along.x + along.y * along.y, b = -(from.x * along.x + from.y * along.y);
    if (!(a > 0)) return std::nullopt;  // the ray is parallel to the axis
    // The discriminant is computed from the distance between axis and line, without cancellation (Haines et
    // al. 2019, "Precision improvements for ray/sphere intersection"); c is factorised, exact near the
    // surface.
    const double r = std::sqrt(from.x * from.x + from.y * from.y), c = (r - 1) * (r + 1);
    const double x = from.x + along.x * (b / a), y = from.y + along.y * (b / a);
    const double discriminant = 1 - (x * x + y * y);
    if (!(discriminant >= 0)) return std::nullopt;
    const double q = b + std::copysign(std::sqrt(a * discriminant), b);
    double t[2] = {q != 0 ? c / q : 0, q / a};
    if (t[0] > t[1]) std::swap(t[0], t[1]);
    for (const double at : t) {
      const double z = from.z + along.z * at;
      if (at > t_min && at < t_max && z >= 0 && z <= 1) return at;
    }
    return std::nullopt;
  }
};

class Cylinder final : public Shape, public RoundShape {
public:
  explicit Cylinder(const Properties& properties)
      : Shape(properties), cylinder_{Placement(own_to_world(properties))} {
    flipped_ = properties.get_bool("flip_normals", false);
  }

  RTCGeometry make_geometry(RTCDevice device) const override { return make_user_geometry(device, cylinder_); }
  SurfacePoint surface_point(const ShapeHit& hit, const Ray& ray, bool) const override {
    const Double3 at = cylinder_.place.local_point(Double3(ray.o) + Double3(ray.d) * double(hit.t));
    return point_at(at.x, at.y, at.z);
  }
  Bounds3 bounds() const override { return cylinder_.bounds(); }
  std::size_t primitive_count() const override { return 1; }
  std::string opening() const override { return "a cylinder has no caps"; }

  SurfaceDerivatives own_derivatives(const SurfacePoint& point) const override;
  std::shared_ptr<const AreaSampler> make_area_sampler(AreaUse use) const override;

  double round_radius() const override {
    return std::max(length(cylinder_.place.axis(0)), length(cylinder_.place.axis(1)));
  }
  bool is_curved() const override { return true; }
  bool has_rims() const override { return true; }
  double edge_count(int pieces) const override { return 3.0 * pieces; }
  OutlineMesh outline_mesh(int pieces) const override {
    OutlineMesh mesh;
    const auto n = std::uint32_t(pieces);
    for (const Double3& corner : polygon_around_circle(pieces, cylinder_.place))
      for (const double z : {0.0, 1.0}) mesh.add(cylinder_.place.point({corner.x, corner.y, z}));
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = 2 * i, b = 2 * ((i + 1) % n);
      mesh.triangles.push_back({a, b, b + 1});
      mesh.triangles.push_back({a, b + 1, a + 1});
    }
    return mesh;
  }

  const Placement& place() const { return cylinder_.place; }
  bool is_flipped() const { return flipped_; }
  /// Returns the surface point with the given local coordinates, moved onto the surface.
  SurfacePoint point_at(double x, double y, double z) const;

private:
  static Transform own_to_world(const Properties& properties);

  PlacedCylinder cylinder_;
  bool flipped_ = false;
};
class CylinderSampler final : public AreaSampler {
public:
  CylinderSampler(const Cylinder& cylinder, AreaUse use) : cylinder_(cylinder) {
    const Double3 &x = place().axis(0), &y = place().axis(1), &z = place().axis(2);
    radius_ = length(x), length_ = length(z);
    const auto across = [](const Double3& a, const Double3& b) {
      return std::abs(dot(a, b)) < 1e-5 * length(a) * length(b);
    };
    is_round_ =
        std::abs(length(y) - radius_) < 1e-5 * radius_ && across(x, y) && across(y, z) && across(z, x);
    // Few points suffice for nearly circular ellipses, since the integrand is smooth and periodic.
    constexpr int kPoints = 256;
    for (int i = 0; i < kPoints; ++i) {
      const double phi = 2 * kPiD * i / kPoints;
      area_ += area_element(std::cos(phi), std::sin(phi)) * (2 * kPiD / kPoints);
    }
    if (use == AreaUse::emitter && !(area_ > 0 && std::isfinite(float(area_))))
      throw cylinder.properties().error("radius",
                                        "an emitter needs an area that is neither zero nor infinite");
  }

  float patch_area(std::size_t) const override { return float(area_); }
  Bounds3 patch_bounds(std::size_t) const override { return cylinder_.bounds(); }
  std::pair<Vec3, float> patch_normals(std::size_t) const override { return {{0, 0, 1}, -1.f}; }
  std::optional<ShapeSample> sample_direct(const Vec3& reference, std::size_t, Vec2 u) const override;
  std::optional<ShapeSample> sample_area(std::size_t, Vec2 u) const override;
  std::optional<ShapeSample> point_at_uv(Vec2 uv) const override {
    const double phi = 2 * kPiD * uv.x, x = std::cos(phi), y = std::sin(phi);
    const SurfacePoint s = cylinder_.point_at(x, y, uv.y);
    return ShapeSample{s.p, s.p_error, s.ng, uv, float(1 / (2 * kPiD * area_element(x, y)))};
  }
  float pdf_area(std::size_t, const SurfacePoint& point) const override {
    const Double3 at = place().local_point(Double3(point.p));
    const double r = std::hypot(at.x, at.y);
    return float(1 / (2 * kPiD * area_element(at.x / r, at.y / r)));
  }
  float pdf_direct(const Vec3& reference, std::size_t, const SurfacePoint& point) const override {
    return is_round_ ? float(round_view(reference).pdf(scaled(place().local_point(Double3(point.p)))))
                     : pdf_by_area(affine_view(reference), reference, point.p, point.ng);
  }

private:
  const Placement& place() const { return cylinder_.place(); }
  /// Local coordinates of a round cylinder in units of the scene.
  Double3 scaled(const Double3& p) const { return {p.x * radius_, p.y * radius_, p.z * length_}; }
  RoundView round_view(const Vec3& reference) const {
    return {scaled(place().local_point(Double3(reference))), radius_, length_, cylinder_.is_flipped()};
  }
  AffineView affine_view(const Vec3& reference) const {
    return {place().local_point(Double3(reference)), cylinder_.is_flipped()};
  }
  float pdf_by_area(const AffineView& seen, const Vec3& reference, const Vec3& p, const Vec3& ng) const;
  /// Returns the area per azimuth and z at a point of the unit circle.
  double area_element(double x, double y) const {
    return length(cross(place().vector({-y, x, 0}), place().axis(2)));
  }

  const Cylinder& cylinder_;
  double area_ = 0;
  double radius_ = 0, length_ = 0;  ///< radius and length of a round cylinder
  bool is_round_ = false;           ///< whether the cylinder is right circular, neither elliptic nor oblique
};

std::shared_ptr<const AreaSampler> Cylinder::make_area_sampler(AreaUse use) const {
  return std::make_shared<const CylinderSampler>(*this, use);
}

Transform Cylinder::own_to_world(const Properties& properties) {
  const Vec3 p0 = properties.get_vec3("p0", {0, 0, 0}), p1 = properties.get_vec3("p1", {0, 0, 1});
  const double radius = properties.get_float("radius", 1.0, Range::positive());
  const Double3 along = Double3(p1) - Double3(p0);
  const double l = length(along);
  if (!(l > 0)) throw properties.error("p1", "p0 and p1 are the same point: the cylinder has no length");
  Double3 s, t;
  make_basis(along * (1 / l), s, t);
  const Transform own(Transform::Matrix{{{s.x * radius, t.x * radius, along.x, p0.x},
                                         {s.y * radius, t.y * radius, along.y, p0.y},
                                         {s.z * radius, t.z * radius, along.z, p0.z},
                                         {0, 0, 0, 1}}});
  const Transform all = properties.get_transform("to_world") * own;
  if (all.is_singular()) throw properties.error("to_world", "the cylinder is too thin or too short");
  return all;
}

SurfacePoint Cylinder::point_at(double x, double y, double z) const {
  const double r = std::hypot(x, y);
  if (r > 0) x /= r, y /= r;
  z = std::clamp(z, 0.0, 1.0);
  const Placement& place = cylinder_.place;
  SurfacePoint s;
  s.p = place.point({x, y, z}).to_float();
  s.p_error = place.rounding_error(s.p);
  const Double3 n = normalize(place.normal({x, y, 0}));
  s.ng = (flipped_ ? -n : n).to_float();
  const double u = std::atan2(y, x) / (2 * kPiD);
  s.uv = {float(u < 0 ? u + 1 : u), float(z)};
  s.shading = Frame::from_normal_tangent(s.ng, place.vector({-y, x, 0}).to_float());
  s.shape = this;
  return s;
}

SurfaceDerivatives Cylinder::own_derivatives(const SurfacePoint& point) const {
  const double phi = 2 * kPiD * point.uv.x;
  const Double3 around = cylinder_.place.vector({-std::sin(phi), std::cos(phi), 0});
  return {(around * (2 * kPiD)).to_float(), cylinder_.place.axis(2).to_float()};
}

float CylinderSampler::pdf_by_area(const AffineView& seen, const Vec3& reference, const Vec3& p,
                                   const Vec3& ng) const {
  if (seen.empty()) return 0;
  const Double3 at = place().local_point(Double3(p));
  const double r = std::sqrt(at.x * at.x + at.y * at.y);
  const float pdf = area_sampling_pdf(reference, p, ng, area_element(at.x / r, at.y / r) / seen.pdf());
  return std::isfinite(pdf) ? pdf : 0;
}

std::optional<ShapeSample> CylinderSampler::sample_direct(const Vec3& reference, std::size_t, Vec2 u) const {
  SurfacePoint s;
  float pdf = 0;
  if (is_round_) {
    const RoundView seen = round_view(reference);
    Double3 p;
    if (seen.empty() || !seen.sample(u, p)) return std::nullopt;
    s = cylinder_.point_at(p.x / radius_, p.y / radius_, p.z / length_);
    pdf = float(seen.pdf(scaled(place().local_point(Double3(s.p)))));
  } else {
    const AffineView seen = affine_view(reference);
    if (seen.empty()) return std::nullopt;
    const Double3 p = seen.sample(u);
    s = cylinder_.point_at(p.x, p.y, p.z);
    pdf = pdf_by_area(seen, reference, s.p, s.ng);
  }
  if (!(pdf > 0)) return std::nullopt;
  return ShapeSample{s.p, s.p_error, s.ng, s.uv, pdf};
}

std::optional<ShapeSample> CylinderSampler::sample_area(std::size_t, Vec2 u) const {
  // Azimuths are not uniform over the area of an elliptic cylinder, so the pdf depends on the point.
  const double x = std::cos(2 * kPiD * u.x), y = std::sin(2 * kPiD * u.x);
  const SurfacePoint s = cylinder_.point_at(x, y, u.y);
  return ShapeSample{s.p, s.p_error, s.ng, s.uv, float(1 / (2 * kPiD * area_element(x, y)))};
}

AUREOLE_PLUGIN(
    Cylinder, "shape", "cylinder",
    PluginDoc{
        .summary = "An open cylinder (no end caps) around the line from p0 to p1. Its normals point "
                   "outward, so that most materials are black inside; `twosided` changes that. Texture "
                   "coordinates: u is the angle about the axis, v runs from p0 to p1. Any affine to_world "
                   "is exact. As an emitter, a right circular cylinder is sampled nearly uniformly in solid "
                   "angle, others in area.",
        .source = "",
        .parameters = {{"p0", "vector", "scene units", "0, 0, 0", "one end of the axis, before to_world"},
                       {"p1", "vector", "scene units", "0, 0, 1", "other end of the axis, before to_world"},
                       {"radius", "float", "scene units", "1", "radius, before to_world"}},
        .examples = {R"(<shape type="cylinder">
  <point name="p0" x="0" y="0" z="-1"/>
  <point name="p1" x="0" y="0" z="1"/>
  <float name="radius" value="0.1"/>
  <boolean name="flip_normals" value="false"/>
  <transform name="to_world"><rotate x="1" angle="90"/></transform>
  <bsdf type="diffuse"/>
  <emitter type="area"><float name="radiance" value="1"/></emitter>
</shape>)"}});

}  // namespace
}  // namespace aureole
