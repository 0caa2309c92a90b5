// SPDX-License-Identifier: Apache-2.0
// A pane: two parallel dielectric interfaces as one surface, thin compared with the scene and thick compared
// with the coherence length.
#include <cmath>

#include "aureole/bsdf/bsdf.h"
#include "aureole/plugin/registry.h"
#include "aureole/spectrum/fresnel.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

class ThinDielectric final : public Bsdf {
public:
  explicit ThinDielectric(const Properties& properties)
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
    const Spectrum r = reflectance(cos_i, ctx);
    const float mass = mean(r);  // the probability of a null lobe must not depend on the wavelength
    if (u1 < mass) {
      BsdfSample s{reflect(wi), r, mass, Lobe::delta | Lobe::reflect};
      if (reflectance_) s.value *= reflectance_->eval(ctx.point, ctx.wavelengths);
      return s;
    }
    return BsdfSample{-wi, transmittance(r, ctx), 1 - mass, kNullLobe};
  }

  Spectrum null_transmittance(const Vec3& wi, const BsdfContext& ctx) const override {
    const float cos_i = std::abs(wi.z);
    return cos_i > 0 ? transmittance(reflectance(cos_i, ctx), ctx) : 0.f;
  }

  bool needs_tangent() const override { return false; }
  Lobe lobes() const override { return kNullLobe | Lobe::reflect | Lobe::through; }

private:
  /// Reflectance of the pane, with the reflections within it.
  Spectrum reflectance(float cos_i, const BsdfContext& ctx) const {
    if (dispersive_ || ctx.exterior_index)
      return thin_slab(
          fresnel_dielectric(cos_i, interior_.eval(ctx.wavelengths) / ctx.eval_exterior(exterior_)));
    return thin_slab(fresnel_dielectric(cos_i, eta_).reflectance);
  }
  Spectrum transmittance(const Spectrum& reflected, const BsdfContext& ctx) const {
    const Spectrum t = Spectrum(1.f) - reflected;
    return transmittance_ ? t * transmittance_->eval(ctx.point, ctx.wavelengths) : t;
  }

  Ior interior_, exterior_;
  bool dispersive_;
  float eta_;  // index of refraction of a pane without dispersion
  TexturePtr reflectance_, transmittance_;
};

AUREOLE_PLUGIN(
    ThinDielectric, "bsdf", "thindielectric",
    PluginDoc{
        "A pane of a transparent material as one surface: both faces and all reflections between them, R' = "
        "2R/(1 + R) with the reflectance R of one face. Transmitted light keeps its direction: light sampling passes "
        "through the pane, and crossing it is no path vertex (`count_crossings` of the integrator says whether it "
        "counts for `max_depth`). As in Mitsuba, polarisation within the pane is neglected.",
        "M. Born, E. Wolf, Principles of Optics, 7th ed. 1999, section 1.5.2; the sum over reflections is "
        "geometric",
        {{"int_ior", "float or string", "", "1.5046",
          "index of refraction of the pane, as a number or the name of a material"},
         {"ext_ior", "float or string", "", "air",
          "index of refraction around it, as a number or the name of a material"},
         {"dispersion", "boolean", "", "true", "named materials use their dispersion data if available"},
         {"specular_reflectance", "texture", "", "1",
          "factor of the reflected light; leave at 1 for a real pane"},
         {"specular_transmittance", "texture", "", "1", "factor of the transmitted light, for tinted glass"}},
        {R"(<bsdf type="thindielectric">
    <string name="int_ior" value="bk7"/>
    <string name="ext_ior" value="air"/>
    <boolean name="dispersion" value="false"/>
</bsdf>)",
         R"(<bsdf type="thindielectric">
    <float name="int_ior" value="1.5"/>
    <float name="specular_reflectance" value="0.9"/>
    <rgb name="specular_transmittance" value="0.7, 0.9, 0.8"/>
</bsdf>)"}});

}  // namespace
}  // namespace aureole
