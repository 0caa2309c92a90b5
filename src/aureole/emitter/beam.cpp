// SPDX-License-Identifier: Apache-2.0
// A shape whose light all passes a disc: the exit pupil of a projector that images a round field stop onto a sample.
#include <algorithm>
#include <cmath>

#include "aureole/emitter/light.h"
#include "aureole/emitter/surface/cosine_rays.h"
#include "aureole/plugin/registry.h"
#include "aureole/shape/area_sampler.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

class BeamEmitter final : public Emitter {
public:
  explicit BeamEmitter(const Properties& p)
      : Emitter(p),
        radiance_(get_texture(p, "radiance", 1, SpectrumRole::emission)),
        target_(p.get_vec3("target", {})),
        normal_(p.get_vec3("target_normal", {0, 0, 1})),
        radius_(float(p.get_float("target_radius", Range::positive()))) {
    if (!radiance_->is_constant())
      throw p.error("radiance", "expected a spectrum; the pupil of a beam has the same radiance everywhere");
    const float length_of_normal = length(normal_);
    if (!(length_of_normal > 1e-12f) || !is_finite(normal_))
      throw p.error("target_normal", "expected a direction, not a zero vector");
    normal_ = normal_ / length_of_normal;
  }

  std::shared_ptr<const Emitter> fitted_to(const Light& light) const override {
    if (!(light.surface_area > 0)) throw Error(properties().where(), "the shape of a beam has no area");
    auto fitted = std::make_shared<BeamEmitter>(*this);
    // Where the disc is wide as seen from the shape, directions are sampled by the cosine, else towards its points.
    float nearest = kInfinity;
    for (std::size_t part = 0; part < light.area->patch_count(); ++part)
      if (const auto s = light.area->sample_area(part, {0.5f, 0.5f}))
        nearest = std::min(nearest, length(s->p - target_));
    fitted->is_wide_ = !(radius_ < 0.5f * nearest);
    fitted->etendue_ = fitted->etendue_of(light);
    if (!(fitted->etendue_ > 0))
      throw Error(properties().where(),
                  "no light of the shape passes the target: it faces away from the disc");
    return fitted;
  }

  std::size_t part_count(const Light& light) const override { return light.area->patch_count(); }
  std::size_t part_of(const Light& light, const SurfacePoint& point) const override {
    return light.area->patch_of_primitive(point.primitive);
  }

  Spectrum eval(const SurfacePoint& point, const Vec3& w, const Wavelengths& wavelengths) const override {
    return dot(point.ng, w) > 0 && passes(point.p, w) ? radiance_->eval({}, wavelengths) : Spectrum(0.f);
  }

  std::optional<DirectSample> sample_direct(const Light& light, const Vec3& reference, std::size_t part,
                                            Vec2 u, const Wavelengths& wavelengths) const override {
    const PositionSample s = light.area->sample_direct_position(reference, part, u);
    if (!(s.pdf > 0)) return {};
    DirectSample d;
    d.wo = normalize(s.p - reference);
    if (!(dot(s.ng, d.wo) < 0) || !passes(s.p, -d.wo)) return {};
    d.p = s.p, d.p_error = s.p_error, d.ng = s.ng, d.pdf = s.pdf;
    d.radiance = radiance_->eval({}, wavelengths);
    return d;
  }

  std::optional<EmittedRay> sample_ray(const Light& light, std::size_t part, Vec2 position, Vec2 direction,
                                       const Wavelengths& wavelengths) const override {
    if (is_wide_)
      return sample_cosine_ray(light, part, position, direction, [&](const auto& s, const Vec3& d) {
        return passes(s.p, d) ? radiance_->eval({}, wavelengths) : Spectrum(0.f);
      });
    const auto s = light.area->sample_area(part, position);
    if (!s) return {};
    const Vec3 d = normalize(disc_point(direction) - s->p);
    const float cosine = dot(s->ng, d), density = disc_density(s->p, d);
    if (!(cosine > 0 && density > 0)) return {};
    return EmittedRay{s->p, s->p_error, s->ng, d, radiance_->eval({}, wavelengths) * cosine, s->pdf, density};
  }

  RayDensity pdf_ray(const Light& light, std::size_t part, const SurfacePoint* point,
                     const Vec3& d) const override {
    if (is_wide_) return cosine_ray_density(light, part, *point, d);
    const bool leaves = dot(point->ng, d) > 0 && passes(point->p, d);
    return {light.area->pdf_area(part, *point), leaves ? disc_density(point->p, d) : 0.f};
  }

  float pdf_direct(const Light& light, const Vec3& reference, std::size_t part,
                   const SurfacePoint& point) const override {
    return light.area->pdf_direct(reference, part, point);
  }

  SampledSpectrum power_spectrum(const Light&) const override {
    SampledSpectrum s = radiance_->average();
    s.scale(float(etendue_));
    return s;
  }

  EmissionBounds emission_bounds(const Light& light, std::size_t part) const override {
    const auto [axis, cosine] = light.area->patch_normals(part);
    return {light.area->patch_bounds(part),
            axis,
            cosine,
            0,
            patch_fraction(light, part),
            float(kPiD * light.surface_area / etendue_)};
  }

private:
  /// Whether a ray from p in the direction d passes the target.
  bool passes(const Vec3& p, const Vec3& d) const {
    const float slope = dot(d, normal_);
    if (slope == 0) return false;
    const float t = dot(target_ - p, normal_) / slope;
    return t > 0 && length_squared(p + d * t - target_) <= radius_ * radius_;
  }
  Vec3 disc_point(Vec2 u) const {
    const Vec2 disc = square_to_disc_concentric(u).p;
    return target_ + Frame::from_normal(normal_).to_world({disc.x, disc.y, 0}) * radius_;
  }
  /// The pdf [1/sr] of directions from p to uniform points of the disc.
  float disc_density(const Vec3& p, const Vec3& d) const {
    const float slope = std::abs(dot(d, normal_));
    if (!(slope > 0)) return 0;
    const float t = std::abs(dot(target_ - p, normal_)) / slope;
    return t * t / (slope * kPi * radius_ * radius_);
  }
  /// The integral of the cosine over the area of the shape and the directions that pass the target [m^2 sr], by points
  /// of an additive recurrence (M. Roberts 2018).
  double etendue_of(const Light& light) const {
    constexpr int kPoints = 4096;
    double sum = 0;
    for (std::size_t part = 0; part < light.area->patch_count(); ++part)
      for (int k = 0; k < kPoints; ++k) {
        const auto point = [&](double a, double b) {
          const double x = 0.5 + a * k, y = 0.5 + b * k;
          return Vec2{float(x - std::floor(x)), float(y - std::floor(y))};
        };
        const Vec2 u = point(0.8566748838545029, 0.733891856627126),
                   v = point(0.6287067210378087, 0.5385972572236101);
        const auto s = light.area->sample_area(part, u);
        if (!s || !(s->pdf > 0)) continue;
        if (is_wide_) {
          const Vec3 d = Frame::from_normal(s->ng).to_world(square_to_cosine_hemisphere(v));
          if (passes(s->p, d)) sum += kPiD / double(s->pdf) / kPoints;
          continue;
        }
        const Vec3 d = normalize(disc_point(v) - s->p);
        const double cosine = double(dot(s->ng, d)), density = double(disc_density(s->p, d));
        if (cosine > 0 && density > 0) sum += cosine / (density * double(s->pdf)) / kPoints;
      }
    return sum;
  }

  TexturePtr radiance_;
  Vec3 target_, normal_;
  float radius_;
  bool is_wide_ = false;
  double etendue_ = 0;
};

AUREOLE_PLUGIN(
    BeamEmitter, "emitter", "beam",
    PluginDoc{
        .summary =
            "Its parent shape is the exit pupil of a projector whose round field stop is imaged onto a disc, the target: "
            "each of its points emits the same radiance towards all points of the target and nothing elsewhere. The target "
            "is evenly irradiated, from within the solid angle of the shape, and its edge is sharp. Light that passes the "
            "target goes on. `aureole spectrophotometer` and `aureole goniometer` light samples with it.",
        .source = "A. Koehler, Ein neues Beleuchtungsverfahren fuer mikrophotographische Zwecke, 1893",
        .parameters = {{"radiance", "spectrum", "W/(m^2 sr nm), any common scale", "1",
                        "emitted spectral radiance"},
                       {"target", "vector", "scene units", "0, 0, 0", "centre of the target, in the world"},
                       {"target_normal", "vector", "", "0, 0, 1", "normal of the target, in the world"},
                       {"target_radius", "float", "scene units", "required", "radius of the target"}},
        .examples = {R"(<emitter type="beam">
    <spectrum name="radiance" value="400:1, 700:2"/>
    <point name="target" x="0" y="0" z="3"/>
    <vector name="target_normal" x="0" y="0" z="1"/>
    <float name="target_radius" value="0.5"/>
</emitter>)"},
        .needs_shape = true});

}  // namespace
}  // namespace aureole
