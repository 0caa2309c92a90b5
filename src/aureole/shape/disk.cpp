// SPDX-License-Identifier: Apache-2.0
// A flat disc with Mitsuba 3's conventions: texture coordinates are polar, u = r and v = phi / 2 pi. Any
// affine to_world makes it an ellipse.
#include <algorithm>

#include "aureole/math/warp.h"
#include "aureole/plugin/registry.h"
#include "aureole/shape/geometry/outline.h"
#include "aureole/shape/geometry/shape_placement.h"
#include "aureole/shape/geometry/user_geometry.h"
#include "aureole/shape/sampling/disc_sampling.h"
#include "aureole/shape/sampling/spherical_sampling.h"
#include "aureole/shape/shape.h"

namespace aureole {
namespace {

/// The unit disc in the plane z = 0 of a placement.
struct PlacedDisc {
  Placement place;

  Bounds3 bounds() const {
    const Double3 &u = place.axis(0), &v = place.axis(1);
    const Double3 reach(std::hypot(u.x, v.x), std::hypot(u.y, v.y), std::hypot(u.z, v.z));
    return outward_bounds(place.origin() - reach, place.origin() + reach);
  }
  std::optional<double> intersect(const Double3& o, const Double3& d, double t_min, double t_max) const {
    const Double3 from = place.local_point(o), along = place.local_vector(d);
    const double t = -from.z / along.z;
    // true as well where the ray is parallel to the plane
    if (!(t > t_min && t < t_max)) return std::nullopt;
    const double x = from.x + along.x * t, y = from.y + along.y * t;
    return x * x + y * y <= 1 ? std::optional<double>(t) : std::nullopt;
  }
};

class Disk final : public Shape, public RoundShape {
public:
  explicit Disk(const Properties& properties)
      : Shape(properties), disc_{Placement(properties.get_transform("to_world"))} {
    const Double3 n = normalize(disc_.place.normal({0, 0, 1}));
    normal_ = properties.get_bool("flip_normals", false) ? -n : n;
  }

  RTCGeometry make_geometry(RTCDevice device) const override { return make_user_geometry(device, disc_); }
  SurfacePoint surface_point(const ShapeHit& hit, const Ray& ray, bool) const override {
    const Double3 at = disc_.place.local_point(Double3(ray.o) + Double3(ray.d) * double(hit.t));
    return point_at(at.x, at.y);
  }
  Bounds3 bounds() const override { return disc_.bounds(); }
  std::size_t primitive_count() const override { return 1; }
  std::string opening() const override { return "a disk has an edge"; }

  SurfaceDerivatives own_derivatives(const SurfacePoint& point) const override {
    const double phi = 2 * kPiD * point.uv.y, c = std::cos(phi), s = std::sin(phi);
    return {disc_.place.vector({c, s, 0}).to_float(),
            (disc_.place.vector({-s, c, 0}) * (2 * kPiD * point.uv.x)).to_float()};
  }
  /// Returns the surface point with the given local coordinates; points that rounding moved beyond the rim
  /// are moved back onto it.
  SurfacePoint point_at(double x, double y) const {
    const double r = std::hypot(x, y);
    if (r > 1) x /= r, y /= r;
    SurfacePoint s;
    s.p = disc_.place.point({x, y, 0}).to_float();
    s.p_error = disc_.place.rounding_error(s.p);
    s.ng = normal_.to_float();
    const double v = std::atan2(y, x) / (2 * kPiD);
    s.uv = {float(std::min(r, 1.0)), float(v < 0 ? v + 1 : v)};
    s.shading = Frame::from_normal_tangent(s.ng, disc_.place.vector({x, y, 0}).to_float());
    s.shape = this;
    return s;
  }
  std::shared_ptr<const AreaSampler> make_area_sampler(AreaUse use) const override;

  double round_radius() const override {
    return std::max(length(disc_.place.axis(0)), length(disc_.place.axis(1)));
  }
  bool is_curved() const override { return false; }
  bool has_rims() const override { return true; }
  double edge_count(int pieces) const override { return pieces; }
  OutlineMesh outline_mesh(int pieces) const override {
    OutlineMesh mesh;
    const auto n = std::uint32_t(pieces), middle = mesh.add(disc_.place.origin());
    for (const Double3& corner : polygon_around_circle(pieces, disc_.place))
      mesh.add(disc_.place.point(corner));
    for (std::uint32_t i = 0; i < n; ++i) mesh.triangles.push_back({middle, 1 + i, 1 + (i + 1) % n});
    return mesh;
  }

  const Placement& place() const { return disc_.place; }
  const Double3& normal() const { return normal_; }

private:
  PlacedDisc disc_;
  Double3 normal_;
};

class DiskSampler final : public AreaSampler {
public:
  DiskSampler(const Disk& disk, AreaUse use) : disk_(disk) {
    const Double3 &u = disk.place().axis(0), &v = disk.place().axis(1);
    area_ = kPiD * length(cross(u, v));
    const double a = length(u), b = length(v);
    circular_ = std::abs(a - b) < 1e-5 * a && std::abs(dot(u, v)) < 1e-5 * a * b;
    if (use == AreaUse::emitter && !(area_ > 0 && std::isfinite(float(area_))))
      throw disk.properties().error("to_world", "an emitter needs an area that is neither zero nor infinite");
  }

  float patch_area(std::size_t) const override { return float(area_); }
  Bounds3 patch_bounds(std::size_t) const override { return disk_.bounds(); }
  std::pair<Vec3, float> patch_normals(std::size_t) const override {
    return {disk_.normal().to_float(), 1.f};
  }
  std::optional<ShapeSample> sample_direct(const Vec3& reference, std::size_t, Vec2 u) const override;
  std::optional<ShapeSample> sample_area(std::size_t, Vec2 u) const override {
    const Vec2 at = square_to_disc_concentric(u).p;
    return sample_at(at.x, at.y, float(1 / area_));
  }
  float pdf_direct(const Vec3& reference, std::size_t, const SurfacePoint& point) const override {
    return pdf_direct(view(reference), reference, point.p);
  }
  std::optional<ShapeSample> point_at_uv(Vec2 uv) const override {
    const double phi = 2 * kPiD * uv.y;
    return sample_at(uv.x * std::cos(phi), uv.x * std::sin(phi), float(1 / (2 * area_ * double(uv.x))));
  }

private:
  ShapeSample sample_at(double x, double y, float pdf) const {
    const SurfacePoint s = disk_.point_at(x, y);
    return {s.p, s.p_error, s.ng, s.uv, pdf};
  }
  DiscView view(const Vec3& reference) const {
    if (!circular_) return DiscView::by_area(Double3(reference), disk_.place().origin(), disk_.normal());
    return DiscView::of(Double3(reference), disk_.place().origin(), disk_.normal(),
                        length(disk_.place().axis(0)));
  }
  float pdf_direct(const DiscView& seen, const Vec3& reference, const Vec3& p) const {
    switch (seen.technique()) {
      case DiscView::Technique::none:
        return 0;
      case DiscView::Technique::area: {
        const float pdf = area_sampling_pdf(reference, p, disk_.normal().to_float(), area_);
        return std::isfinite(pdf) ? pdf : 0;
      }
      case DiscView::Technique::solid_angle:
        return float(seen.pdf(Double3(p) - Double3(reference)));
    }
    return 0;
  }

  const Disk& disk_;
  double area_ = 0;
  bool circular_ = false;
};

std::shared_ptr<const AreaSampler> Disk::make_area_sampler(AreaUse use) const {
  return std::make_shared<const DiskSampler>(*this, use);
}

std::optional<ShapeSample> DiskSampler::sample_direct(const Vec3& reference, std::size_t, Vec2 u) const {
  const DiscView seen = view(reference);
  if (seen.technique() == DiscView::Technique::none) return std::nullopt;
  Double3 at;
  if (seen.technique() == DiscView::Technique::area) {
    const Vec2 on_disc = square_to_disc_concentric(u).p;
    at = {on_disc.x, on_disc.y, 0};
  } else {
    at = disk_.place().local_point(seen.sample(u));
  }
  ShapeSample s = sample_at(at.x, at.y, 0);
  s.pdf = pdf_direct(seen, reference, s.p);
  return s.pdf > 0 ? std::optional<ShapeSample>(s) : std::nullopt;
}

AUREOLE_PLUGIN(
    Disk, "shape", "disk",
    PluginDoc{
        .summary =
            "The disc of radius 1 around the origin in the plane z = 0, normal +z. Texture coordinates are "
            "polar: u is the radius, v the angle divided by 2 pi. A to_world that scales its axes "
            "differently makes it an ellipse. As an emitter, a disc is sampled nearly uniformly in solid "
            "angle, an ellipse in area.",
        .source = "Cone of directions: Guillen, Urena, King, Fajardo, Georgiev, Lopez-Moreno & Jarabo 2017, "
                  "\"Area-preserving parameterizations for spherical ellipses\", section 3.",
        .parameters = {},
        .examples = {R"(<shape type="disk">
  <transform name="to_world">
    <scale value="0.5"/>
    <translate z="2"/>
  </transform>
  <boolean name="flip_normals" value="true"/>
  <bsdf type="diffuse"/>
  <emitter type="area"><float name="radiance" value="1"/></emitter>
</shape>)"}});

}  // namespace
}  // namespace aureole
