// SPDX-License-Identifier: Apache-2.0
// Parallel light from infinity, such as sunlight without the angular size of the sun.
#include "aureole/emitter/amount/emission_amount.h"
#include "aureole/emitter/light.h"
#include "aureole/plugin/registry.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

class DirectionalEmitter final : public Emitter {
public:
  explicit DirectionalEmitter(const Properties& p)
      : Emitter(p), irradiance_(Emission(p, "irradiance").scaled({.irradiance = 1})) {
    if (!irradiance_->is_constant()) throw p.error("irradiance", "expected a spectrum, not a texture");
    if (p.has("direction") && p.has("to_world"))
      throw p.error("direction", "give either \"direction\" or \"to_world\"");
    const Vec3 d = p.get_transform("to_world").vector(p.get_vec3("direction", {0, 0, 1}));
    const float l = length(d);
    if (!(l > 0) || !std::isfinite(l)) throw p.error("direction", "a direction must not be zero");
    direction_ = d * (1 / l);
  }

  bool is_infinite() const override { return true; }
  bool is_delta() const override { return true; }

  std::optional<DirectSample> sample_direct(const Light&, const Vec3&, std::size_t, Vec2,
                                            const Wavelengths& w) const override {
    DirectSample s;
    s.wo = -direction_;
    s.radiance = irradiance_->eval({}, w);
    s.pdf = 1;
    s.delta = s.infinite = true;
    return s;
  }

  std::optional<EmittedRay> sample_ray(const Light& light, std::size_t, Vec2 position, Vec2,
                                       const Wavelengths& w) const override {
    EmittedRay r = ray_from_infinity(light, direction_, position);
    r.value = irradiance_->eval({}, w);
    r.pdf_direction = 1, r.delta_direction = true;
    return r;
  }

  RayDensity pdf_ray(const Light& light, std::size_t, const SurfacePoint*, const Vec3&) const override {
    return density_from_infinity(light, 1);
  }

  SampledSpectrum power_spectrum(const Light& light) const override {
    SampledSpectrum s = irradiance_->average();
    s.scale(kPi * light.scene_radius * light.scene_radius);
    return s;
  }
  EmissionBounds emission_bounds(const Light&, std::size_t) const override { return {}; }

private:
  TexturePtr irradiance_;
  Vec3 direction_;
};

AUREOLE_PLUGIN(
    DirectionalEmitter, "emitter", "directional",
    PluginDoc{
        "Parallel light from infinity over the whole scene.",
        "",
        with_amount_parameters({{"irradiance", "spectrum", "W/(m^2 nm), any common scale", "1",
                                 "spectral irradiance of a surface perpendicular to the light"},
                                {"direction", "vector", "", "0, 0, 1",
                                 "direction in which the light travels"},
                                {"to_world", "transform", "", "identity",
                                 "instead of direction: the light travels along its +z"}},
                               "lx, W/m^2", "irradiance of a surface perpendicular to the light"),
        {R"(<emitter type="directional"><vector name="direction" value="1, 0, -2"/><rgb name="irradiance" value="3, 3, 2.5"/></emitter>)",
         R"(<emitter type="directional"><transform name="to_world"><lookat origin="0, 0, 5" target="1, 2, 0" up="0, 0, 1"/></transform></emitter>)",
         R"(<emitter type="directional"><string name="amount" value="100 klx"/><float name="color_temperature" value="5800"/></emitter>)",
         R"(<emitter type="directional"><string name="amount" value="800 W/m^2"/></emitter>)"}});

}  // namespace
}  // namespace aureole
