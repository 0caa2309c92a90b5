// SPDX-License-Identifier: Apache-2.0
// An environment of constant radiance: the same from every direction at infinity.
#include "aureole/emitter/amount/emission_amount.h"
#include "aureole/emitter/light.h"
#include "aureole/math/warp.h"
#include "aureole/plugin/registry.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

class ConstantEmitter final : public Emitter {
public:
  explicit ConstantEmitter(const Properties& p)
      : Emitter(p), radiance_(Emission(p, "radiance").scaled({.irradiance = 1 / M_PI, .radiance = 1})) {
    if (!radiance_->is_constant())
      throw p.error("radiance", "a constant emitter takes a spectrum, not a texture; use envmap");
  }

  bool is_infinite() const override { return true; }

  Spectrum eval_escaped(const Vec3&, const Wavelengths& w) const override { return radiance_->eval({}, w); }

  std::optional<DirectSample> sample_direct(const Light&, const Vec3&, std::size_t, Vec2 u,
                                            const Wavelengths& w) const override {
    DirectSample s;
    s.wo = square_to_uniform_sphere(u);
    s.radiance = radiance_->eval({}, w);
    s.pdf = uniform_sphere_pdf();
    s.infinite = true;
    return s;
  }
  std::optional<DirectSample> sample_direct_facing(const Light& light, const Vec3& reference,
                                                   const Vec3& facing, std::size_t part, Vec2 u,
                                                   const Wavelengths& w) const override {
    if (facing == Vec3{}) return sample_direct(light, reference, part, u, w);
    const Vec3 local = square_to_cosine_hemisphere(u);
    DirectSample s;
    s.wo = normalize(Frame::from_normal(facing).to_world(local));
    s.radiance = radiance_->eval({}, w);
    s.pdf = cosine_hemisphere_pdf(local.z);
    s.infinite = true;
    return s;
  }
  float pdf_direct_escaped(const Vec3&, const Vec3& facing, const Vec3& d) const override {
    return facing == Vec3{} ? uniform_sphere_pdf() : cosine_hemisphere_pdf(dot(d, facing));
  }

  std::optional<EmittedRay> sample_ray(const Light& light, std::size_t, Vec2 position, Vec2 direction,
                                       const Wavelengths& w) const override {
    EmittedRay r = ray_from_infinity(light, square_to_uniform_sphere(direction), position);
    r.value = radiance_->eval({}, w);
    r.pdf_direction = uniform_sphere_pdf();
    return r;
  }

  RayDensity pdf_ray(const Light& light, std::size_t, const SurfacePoint*, const Vec3&) const override {
    return density_from_infinity(light, uniform_sphere_pdf());
  }

  SampledSpectrum power_spectrum(const Light& light) const override {
    SampledSpectrum s = radiance_->average();
    s.scale(4 * kPi * kPi * light.scene_radius * light.scene_radius);
    return s;
  }
  EmissionBounds emission_bounds(const Light&, std::size_t) const override { return {}; }

private:
  TexturePtr radiance_;
};

AUREOLE_PLUGIN(
    ConstantEmitter, "emitter", "constant",
    PluginDoc{
        "Environment of constant radiance around the scene.",
        "",
        with_amount_parameters({{"radiance", "spectrum", "W/(m^2 sr nm), any common scale", "1",
                                 "spectral radiance"}},
                               "cd/m^2, W/(m^2 sr), lx, W/m^2",
                               "radiance, or the irradiance of a plane by the hemisphere before it"),
        {R"(<emitter type="constant"><rgb name="radiance" value="0.5, 0.7, 1"/></emitter>)",
         R"(<emitter type="constant"><string name="amount" value="10 klx"/><float name="color_temperature" value="6500"/></emitter>)"}});

}  // namespace
}  // namespace aureole
