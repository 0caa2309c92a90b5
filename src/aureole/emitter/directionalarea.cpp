// SPDX-License-Identifier: Apache-2.0
// A shape that emits along its normals only. The probability to sample its directions by next-event
// estimation is zero, so that only light tracing finds this light.
#include "aureole/emitter/amount/emission_amount.h"
#include "aureole/emitter/light.h"
#include "aureole/emitter/surface/cosine_rays.h"
#include "aureole/plugin/registry.h"
#include "aureole/shape/area_sampler.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

class DirectionalAreaEmitter final : public Emitter {
public:
  explicit DirectionalAreaEmitter(const Properties& p) : Emitter(p) {
    const Emission emission(p, "radiance");
    is_flux_ = emission.amount() && emission.amount()->quantity == EmissionAmount::Quantity::flux;
    radiance_ = emission.scaled({.flux = per_square_unit(p), .irradiance = 1});
    p.note("radiance",
           "only light tracing (integrator \"ptracer\") finds the light of a \"directionalarea\"");
  }

  std::shared_ptr<const Emitter> fitted_to(const Light& light) const override {
    if (!is_flux_) return nullptr;
    if (!(light.surface_area > 0))
      throw properties().error("amount", "the shape has no area from which it could emit this flux");
    auto fitted = std::make_shared<DirectionalAreaEmitter>(*this);
    fitted->radiance_ = scaled_texture(radiance_, 1 / light.surface_area);
    return fitted;
  }

  bool is_delta() const override { return true; }
  std::size_t part_count(const Light& light) const override { return light.area->patch_count(); }
  std::size_t part_of(const Light& light, const SurfacePoint& point) const override {
    return light.area->patch_of_primitive(point.primitive);
  }

  std::optional<DirectSample> sample_direct(const Light&, const Vec3&, std::size_t, Vec2,
                                            const Wavelengths&) const override {
    return {};
  }

  std::optional<EmittedRay> sample_ray(const Light& light, std::size_t part, Vec2 position, Vec2,
                                       const Wavelengths& wavelengths) const override {
    const auto s = light.area->sample_area(part, position);
    if (!s) return {};
    SurfacePoint point;
    point.p = s->p, point.ng = s->ng, point.uv = s->uv, point.shape = light.shape;
    point.primitive = s->primitive, point.barycentric = s->barycentric;
    EmittedRay r;
    r.p = s->p, r.p_error = s->p_error, r.ng = r.d = s->ng;
    r.value = radiance_->eval(point, wavelengths);
    r.pdf_position = s->pdf;
    r.pdf_direction = 1, r.delta_direction = true;
    return r;
  }

  RayDensity pdf_ray(const Light& light, std::size_t part, const SurfacePoint* point,
                     const Vec3&) const override {
    return {light.area->pdf_area(part, *point), 1};
  }

  SampledSpectrum power_spectrum(const Light& light) const override {
    SampledSpectrum s = radiance_->average(light.shape);
    s.scale(float(light.surface_area));
    return s;
  }

  EmissionBounds emission_bounds(const Light& light, std::size_t part) const override {
    const auto [axis, cosine] = light.area->patch_normals(part);
    // The cone of emission has zero solid angle; with `focus` 0 light sampling never chooses it.
    return {light.area->patch_bounds(part), axis, cosine, 1, patch_fraction(light, part), 0};
  }

private:
  TexturePtr radiance_;
  bool is_flux_ = false;
};

AUREOLE_PLUGIN(
    DirectionalAreaEmitter, "emitter", "directionalarea",
    PluginDoc{
        .summary =
            "Its parent shape emits along its normals only: a rectangle emits a parallel beam. Light tracing "
            "(`ptracer`, `bdpt`) finds this light; `path` and `direct` cannot.",
        .source = "",
        .parameters = with_amount_parameters(
            {{"radiance", "spectrum", "W/(m^2 nm), any common scale", "1",
              "spectral exitance, the emitted power per area (the name is Mitsuba's); may be a texture"}},
            "lm, W, lx, W/m^2", "flux of the shape, or exitance; of a texture the mean"),
        .examples =
            {R"(<emitter type="directionalarea"><rgb name="radiance" value="4, 5, 6"/></emitter>)",
             R"(<emitter type="directionalarea"><string name="amount" value="5 W"/><float name="efficacy" value="80"/>
    <float name="color_temperature" value="4000"/></emitter>)"},
        .needs_shape = true});

}  // namespace
}  // namespace aureole
