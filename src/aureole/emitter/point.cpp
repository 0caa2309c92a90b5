// SPDX-License-Identifier: Apache-2.0
// An isotropic point light: equal intensity in all directions.
#include "aureole/emitter/amount/emission_amount.h"
#include "aureole/emitter/light.h"
#include "aureole/math/warp.h"
#include "aureole/plugin/registry.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

class PointEmitter final : public Emitter {
public:
  explicit PointEmitter(const Properties& p) : Emitter(p) {
    const Emission emission(p, "intensity");
    intensity_ = emission.texture();
    if (!intensity_->is_constant()) throw p.error("intensity", "expected a spectrum, not a texture");
    motion_ = p.get_motion("to_world");
    if (p.has("position") && p.has("to_world"))
      throw p.error("position", "give either \"position\" or \"to_world\"");
    position_ = p.has("position") ? p.get_vec3("position", {})
                                  : (p.find("position"), motion_.first().point({0, 0, 0}));
    const double per_unit = per_square_unit(p);
    intensity_ = emission.scaled({.flux = per_unit / (4 * M_PI), .intensity = per_unit});
  }

  bool is_delta() const override { return true; }
  bool changes() const override { return motion_.is_moving() || Emitter::changes(); }

  std::optional<DirectSample> sample_direct(const Light&, const Vec3& reference, std::size_t, Vec2,
                                            const Wavelengths& w) const override {
    const Vec3 position = position_at(w), to = position - reference;
    const float d2 = length_squared(to);
    if (!(d2 > 0)) return {};
    DirectSample s;
    s.wo = to * (1 / std::sqrt(d2));
    s.p = position;
    s.radiance = intensity_->eval({}, w) * (1 / d2);
    s.pdf = 1;
    s.delta = true;
    return s;
  }

  std::optional<EmittedRay> sample_ray(const Light&, std::size_t, Vec2, Vec2 direction,
                                       const Wavelengths& w) const override {
    EmittedRay r;
    r.p = position_at(w);
    r.d = square_to_uniform_sphere(direction);
    r.value = intensity_->eval({}, w);
    r.pdf_position = 1, r.delta_position = true;
    r.pdf_direction = uniform_sphere_pdf();
    return r;
  }

  RayDensity pdf_ray(const Light&, std::size_t, const SurfacePoint*, const Vec3&) const override {
    return {1, uniform_sphere_pdf()};
  }

  SampledSpectrum power_spectrum(const Light&) const override {
    SampledSpectrum s = intensity_->average();
    s.scale(4 * kPi);
    return s;
  }
  EmissionBounds emission_bounds(const Light&, std::size_t) const override {
    Bounds3 box{position_, position_};
    for (const KeyFrame& frame : motion_.frames())
      if (motion_.is_moving()) box.extend(frame.transform.point({0, 0, 0}));
    return {box, {0, 0, 1}, -1, 0, 1, 0.25f};
  }

private:
  Vec3 position_at(const Wavelengths& w) const {
    return motion_.is_moving() ? motion_.at(double(w.time)).point({0, 0, 0}) : position_;
  }

  TexturePtr intensity_;
  Motion motion_;
  Vec3 position_;
};

AUREOLE_PLUGIN(
    PointEmitter, "emitter", "point",
    PluginDoc{
        "Isotropic point light.",
        "",
        with_amount_parameters(
            {{"intensity", "spectrum", "W/(sr nm), any common scale", "1", "spectral radiant intensity"},
             {"position", "vector", "scene units", "0, 0, 0", "position of the light"},
             {"to_world", "transform", "", "identity",
              "instead of position: the position is the transformed origin. An `<animation>` of key frames "
              "moves the light"}},
            "lm, W, cd, W/sr", "flux of the light, or its intensity"),
        {R"(<emitter type="point"><point name="position" value="0, 5, 0"/><rgb name="intensity" value="10"/></emitter>)",
         R"(<emitter type="point"><transform name="to_world"><translate y="5"/></transform></emitter>)",
         R"(<emitter type="point"><string name="amount" value="806 lm"/><float name="color_temperature" value="2700"/></emitter>)",
         R"(<emitter type="point"><string name="amount" value="60 W"/><float name="efficacy" value="13.4"/></emitter>)"}});

}  // namespace
}  // namespace aureole
