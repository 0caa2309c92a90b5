// SPDX-License-Identifier: Apache-2.0
// A smooth interface between two transparent media. It has two delta lobes: reflection, and refraction in the
// direction of the hero wavelength.
#include <cmath>

#include "aureole/bsdf/mirror_reflection.h"
#include "aureole/plugin/registry.h"
#include "aureole/spectrum/fresnel.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

class Dielectric final : public Bsdf, public MirrorReflection {
public:
  explicit Dielectric(const Properties& properties)
      : Bsdf(properties),
        interior_(Ior::from(properties, "int_ior", "bk7")),
        exterior_(Ior::from(properties, "ext_ior", "air")),
        dispersive_(interior_.is_dispersive() || exterior_.is_dispersive()),
        eta_(interior_.at_sodium_d() / exterior_.at_sodium_d()),
        reflectance_(get_optional_texture(properties, "specular_reflectance", SpectrumRole::reflectance)),
        transmittance_(
            get_optional_texture(properties, "specular_transmittance", SpectrumRole::reflectance)) {}

  BsdfEval eval_pdf(const Vec3&, const Vec3&, const BsdfContext&) const override { return {}; }

  std::optional<BsdfSample> sample(const Vec3& wi, float u1, Vec2, const BsdfContext& ctx) const override {
    const float cos_i = std::abs(wi.z);
    if (!(cos_i > 0)) return {};
    // eta is the index of refraction beyond the interface over the index on the side of wi.
    const bool disperses = dispersive_ || ctx.exterior_index;
    Spectrum etas(eta_);
    if (disperses) etas = interior_.eval(ctx.wavelengths) / ctx.eval_exterior(exterior_);
    if (wi.z < 0) etas = disperses ? Spectrum(1.f) / etas : Spectrum(1.f / eta_);
    const float eta = etas[0];
    const DielectricFresnel hero = fresnel_dielectric(cos_i, eta);

    if (u1 < hero.reflectance) {
      Spectrum r = disperses ? fresnel_dielectric(cos_i, etas) : Spectrum(hero.reflectance);
      r[0] = hero.reflectance;  // the hero's value is exactly the one that u1 was compared with
      BsdfSample s{reflect(wi), r, r, Lobe::delta | Lobe::reflect};
      if (reflectance_) s.value *= reflectance_->eval(ctx.point, ctx.wavelengths);
      return s;
    }
    // Wavelengths with another index are refracted into other directions and have value 0 in this one.
    Spectrum t(1 - hero.reflectance);
    if (disperses) t = select(etas.v == Spectrum(eta).v, t, 0.f);
    BsdfSample s{refract(wi, hero.cos_t, eta), t, t, Lobe::delta | Lobe::transmit, eta};
    // Radiance is compressed into a smaller solid angle in the denser medium: refraction preserves L/n^2.
    if (ctx.mode == TransportMode::radiance) s.value *= 1 / (eta * eta);
    if (transmittance_) s.value *= transmittance_->eval(ctx.point, ctx.wavelengths);
    return s;
  }

  Amplitudes reflection_amplitudes(float cos_i, const BsdfContext& ctx) const override {
    Spectrum etas(eta_);
    if (dispersive_ || ctx.exterior_index)
      etas = interior_.eval(ctx.wavelengths) / ctx.eval_exterior(exterior_);
    Amplitudes reflected = dielectric_amplitudes(cos_i, etas);
    if (reflectance_) reflected.scale(reflectance_->eval(ctx.point, ctx.wavelengths));
    return reflected;
  }

  bool needs_tangent() const override { return false; }
  bool interior_index(const Wavelengths& w, Spectrum& n) const override {
    n = interior_.eval(w);
    return true;
  }
  bool exterior_index(const Wavelengths& w, Spectrum& n) const override {
    n = exterior_.eval(w);
    return true;
  }
  Lobe lobes() const override { return Lobe::delta | Lobe::reflect | Lobe::transmit; }

private:
  static Vec3 refract(const Vec3& wi, float cos_t, float eta) {
    const float scale = -1 / eta;
    return {scale * wi.x, scale * wi.y, wi.z > 0 ? -cos_t : cos_t};
  }

  Ior interior_, exterior_;
  bool dispersive_;
  float eta_;  // relative index of an interface without dispersion
  TexturePtr reflectance_, transmittance_;
};

AUREOLE_PLUGIN(Dielectric, "bsdf", "dielectric",
               PluginDoc{
                   "A smooth interface between two transparent media, such as glass or water in air: "
                   "Fresnel reflection and refraction. The interior is on the side opposite to the normal. "
                   "A material given by a name with dispersion data (for example bk7) is dispersive. "
                   "Numbers, names without such data, and all names with dispersion switched off have one "
                   "index for all wavelengths, which is Mitsuba's where Mitsuba knows the name.",
                   "M. Born, E. Wolf, Principles of Optics, 7th ed. 1999, section 1.5.2",
                   {{"int_ior", "float or string", "", "1.5046",
                     "index of refraction of the interior, as a number or the name of a material"},
                    {"ext_ior", "float or string", "", "air",
                     "index of refraction of the exterior, as a number or the name of a material"},
                    {"dispersion", "boolean", "", "true",
                     "named materials use their dispersion data if available"},
                    {"specular_reflectance", "texture", "", "1",
                     "factor of the reflected light; leave at 1 for a real interface"},
                    {"specular_transmittance", "texture", "", "1",
                     "factor of the refracted light; leave at 1 for a real interface"}},
                   {R"(<bsdf type="dielectric">
    <string name="int_ior" value="water"/>
    <string name="ext_ior" value="air"/>
</bsdf>)",
                    R"(<bsdf type="dielectric">
    <float name="int_ior" value="1.5"/>
    <rgb name="specular_reflectance" value="0.9, 0.9, 1"/>
    <rgb name="specular_transmittance" value="0.7, 0.9, 0.8"/>
</bsdf>)",
                    R"(<bsdf type="dielectric">
    <string name="int_ior" value="bk7"/>
    <boolean name="dispersion" value="false"/>
</bsdf>)"}});

}  // namespace
}  // namespace aureole
