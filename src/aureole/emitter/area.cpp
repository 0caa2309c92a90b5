// SPDX-License-Identifier: Apache-2.0
// A surface that emits from its front, the side of its geometric normal.
#include "aureole/emitter/amount/emission_amount.h"
#include "aureole/emitter/light.h"
#include "aureole/emitter/surface/cosine_rays.h"
#include "aureole/plugin/registry.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

class AreaEmitter final : public Emitter {
public:
  explicit AreaEmitter(const Properties& p) : Emitter(p) {
    const Emission emission(p, "radiance");
    amount_ = emission.amount();
    is_flux_ = amount_ && amount_->quantity == EmissionAmount::Quantity::flux;
    // A flux is divided by the area of the shape (`fitted_to`).
    radiance_ = emission.scaled({.flux = per_square_unit(p) / M_PI, .irradiance = 1 / M_PI, .radiance = 1});
    is_constant_ = radiance_->is_constant();
  }

  std::shared_ptr<const Emitter> fitted_to(const Light& light) const override {
    if (!is_flux_) return nullptr;
    if (!(light.surface_area > 0))
      throw properties().error("amount", "the shape has no area from which it could emit this flux");
    auto fitted = std::make_shared<AreaEmitter>(*this);
    fitted->radiance_ = scaled_texture(radiance_, 1 / light.surface_area);
    return fitted;
  }

  std::size_t part_count(const Light& light) const override { return light.area->patch_count(); }
  std::size_t part_of(const Light& light, const SurfacePoint& point) const override {
    return light.area->patch_of_primitive(point.primitive);
  }

  Spectrum eval(const SurfacePoint& point, const Vec3& w, const Wavelengths& wavelengths) const override {
    return dot(point.ng, w) > 0 ? radiance_->eval(point, wavelengths) : Spectrum(0.f);
  }

  std::optional<DirectSample> sample_direct(const Light& light, const Vec3& reference, std::size_t part,
                                            Vec2 u, const Wavelengths& wavelengths) const override {
    return sample_direct_facing(light, reference, {}, part, u, wavelengths);
  }

  std::optional<DirectSample> sample_direct_facing(const Light& light, const Vec3& reference,
                                                   const Vec3& facing, std::size_t part, Vec2 u,
                                                   const Wavelengths& wavelengths) const override {
    std::optional<DirectSample> result;
    if (!is_constant_) {
      const auto s = light.area->sample_direct(reference, part, u);
      if (!s || !set_position({s->p, s->p_error, s->ng, s->pdf}, reference, facing, result)) return result;
      result->radiance = radiance_at(light, *s, wavelengths);
      return result;
    }
    static const SurfacePoint kAnywhere;
    if (set_position(light.area->sample_direct_position(reference, part, u), reference, facing, result))
      result->radiance = radiance_->eval(kAnywhere, wavelengths);
    return result;
  }

  std::optional<EmittedRay> sample_ray(const Light& light, std::size_t part, Vec2 position, Vec2 direction,
                                       const Wavelengths& wavelengths) const override {
    return sample_cosine_ray(light, part, position, direction,
                             [&](const auto& s, const Vec3&) { return radiance_at(light, s, wavelengths); });
  }

  RayDensity pdf_ray(const Light& light, std::size_t part, const SurfacePoint* point,
                     const Vec3& d) const override {
    return cosine_ray_density(light, part, *point, d);
  }

  float pdf_direct(const Light& light, const Vec3& reference, std::size_t part,
                   const SurfacePoint& point) const override {
    return light.area->pdf_direct(reference, part, point);
  }

  SampledSpectrum power_spectrum(const Light& light) const override {
    SampledSpectrum s = radiance_->average(light.shape);
    s.scale(float(kPi * light.surface_area));
    return s;
  }

  EmissionBounds emission_bounds(const Light& light, std::size_t part) const override {
    const auto [axis, cosine] = light.area->patch_normals(part);
    return {light.area->patch_bounds(part), axis, cosine, 0, patch_fraction(light, part)};
  }

private:
  /// Sets all members except the radiance. Returns false if the surface faces away or `wo` points behind
  /// `facing`.
  static bool set_position(const PositionSample& s, const Vec3& reference, const Vec3& facing,
                           std::optional<DirectSample>& result) {
    const Vec3 wo = normalize(s.p - reference);
    if (!(s.pdf > 0) || !(dot(s.ng, wo) < 0) || dot(facing, wo) < 0) return false;
    DirectSample& d = result.emplace();
    d.wo = wo, d.p = s.p, d.p_error = s.p_error, d.ng = s.ng, d.pdf = s.pdf;
    return true;
  }
  Spectrum radiance_at(const Light& light, const ShapeSample& s, const Wavelengths& wavelengths) const {
    SurfacePoint point;
    point.p = s.p, point.ng = s.ng, point.uv = s.uv, point.shape = light.shape;
    point.primitive = s.primitive, point.barycentric = s.barycentric;
    return radiance_->eval(point, wavelengths);
  }

  TexturePtr radiance_;
  std::optional<EmissionAmount> amount_;
  bool is_constant_ = false, is_flux_ = false;
};

AUREOLE_PLUGIN(
    AreaEmitter, "emitter", "area",
    PluginDoc{
        .summary =
            "Area light: its parent shape emits the same radiance into all directions from its front side.",
        .source = "",
        .parameters = with_amount_parameters(
            {{"radiance", "spectrum", "W/(m^2 sr nm), any common scale", "1",
              "emitted spectral radiance; may be a texture"}},
            "lm, W, lx, W/m^2, cd/m^2, W/(m^2 sr)",
            "flux of the shape, exitance (flux per area, lx = lm/m^2) or radiance; of a texture the mean"),
        .examples =
            {R"(<emitter type="area"><spectrum name="radiance" value="400:0, 500:8, 700:18"/></emitter>)",
             R"(<emitter type="area"><string name="amount" value="3000 cd/m^2"/><float name="color_temperature" value="4000"/></emitter>)",
             R"(<emitter type="area"><string name="amount" value="36 W"/><float name="efficacy" value="110"/></emitter>)"},
        .needs_shape = true});

}  // namespace
}  // namespace aureole
