// SPDX-License-Identifier: Apache-2.0
// A rough metal: specular microfacets, f = F D G / (4 cos_i cos_o) (Cook & Torrance 1982; Walter et al. 2007,
// equation 20) with Smith's G = G1(wi) G1(wo), single scattering. With `energy_preserving` a second lobe adds
// multiple scattering (Kulla & Conty 2017, "Revisiting physically based shading at Imageworks"):
//     f_ms = F_ms (1 - E(wi)) (1 - E(wo)) / (pi (1 - E_avg)),
// with E the energy that white facets scatter once. It is reciprocal, and a white surface loses nothing.
#include <optional>

#include "aureole/bsdf/bsdf.h"
#include "aureole/bsdf/fresnel/conductor_index.h"
#include "aureole/bsdf/microfacet/microfacet.h"
#include "aureole/bsdf/microfacet/microfacet_energy.h"
#include "aureole/math/warp.h"
#include "aureole/plugin/registry.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

class RoughConductor final : public Bsdf {
public:
  explicit RoughConductor(const Properties& properties)
      : Bsdf(properties),
        index_(ConductorIndex::from(properties)),
        reflectance_(get_optional_texture(properties, "specular_reflectance", SpectrumRole::reflectance)),
        roughness_(properties, true) {
    if (read_energy_preserving(properties))
      loss_ = properties.shared_model<LossTable>(roughness_.table_key(), [&] {
        return std::make_shared<const LossTable>(roughness_, std::vector<float>{1},
                                                 [](const Microfacets& d, const Vec3& wi, float, int points) {
                                                   return mirrored_energy(d, wi, points);
                                                 });
      });
  }

  BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    if (!(wi.z > 0 && wo.z > 0)) return {};
    const State state(*this, wi, ctx);
    return at(state, wi, wo, ctx);
  }

  std::optional<BsdfSample> sample(const Vec3& wi, float u1, Vec2 u2, const BsdfContext& ctx) const override {
    if (!(wi.z > 0)) return {};
    const State state(*this, wi, ctx);
    Vec3 wo;
    if (u1 < state.loss) {
      wo = loss_->sample(state.place, 1, u2);
    } else {
      const Vec3 m = roughness_.visible() ? state.facets.sample_visible(wi, u2) : state.facets.sample_all(u2);
      wo = normalize(2 * dot(wi, m) * m - wi);
    }
    if (!(wo.z > 0)) return {};
    const BsdfEval e = at(state, wi, wo, ctx);
    if (!(e.pdf[0] > 0)) return {};
    return BsdfSample{wo, e.value, e.pdf, lobes()};
  }

  bool needs_tangent() const override { return !roughness_.is_isotropic(); }
  Lobe lobes() const override { return Lobe::glossy | Lobe::reflect; }

private:
  /// Quantities that depend only on wi and the point. `loss` is the probability of the second lobe, one
  /// number for all wavelengths.
  struct State {
    Microfacets facets;
    LossTable::Place place;
    float loss = 0, average_loss = 0;

    State(const RoughConductor& b, const Vec3& wi, const BsdfContext& ctx) : facets(b.roughness_.at(ctx)) {
      if (!b.loss_) return;
      place = b.loss_->locate(facets);
      average_loss = b.loss_->average(place, 1.f);
      // The second lobe is left out where the loss is below single precision.
      if (average_loss > 1e-6f) loss = b.loss_->loss(place, wi, 1.f);
    }
  };

  BsdfEval at(const State& s, const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const {
    const Vec3 sum = wi + wo;
    const float size = length(sum), cos_im = std::min(0.5f * size, 1.f);  // cosine between wi and sum
    if (!(size > 0)) return {};
    const Vec3 m = sum / size;
    const float density = s.facets.density(m), seen = 0.25f * density * s.facets.masking_over_cos(wi);
    const float pdf = roughness_.visible() ? seen : 0.25f * density * m.z / cos_im;
    const Spectrum tint = reflectance_ ? reflectance_->eval(ctx.point, ctx.wavelengths) : Spectrum(1.f);
    BsdfEval e{index_.reflectance(cos_im, ctx) * tint * (seen * s.facets.masking(wo)), pdf};
    if (s.loss > 0) {
      // Light that hits facets twice or more: each reflection keeps F_avg of it, and E_avg of the rest
      // escapes after each reflection.
      const Spectrum f = index_.diffuse_reflectance(ctx) * tint;
      const Spectrum f_ms = f * f * (1 - s.average_loss) / (Spectrum(1.f) - f * s.average_loss);
      const float cosine = cosine_hemisphere_pdf(wo.z);
      e.value += f_ms * (s.loss * loss_->loss(s.place, wo, 1.f) / s.average_loss * cosine);
      e.pdf = e.pdf * (1 - s.loss) + s.loss * loss_->density_over_cosine(s.place, wo.z, 1.f) * cosine;
    }
    return e;
  }

  ConductorIndex index_;
  TexturePtr reflectance_;
  Roughness roughness_;
  std::shared_ptr<const LossTable> loss_;  ///< table of the lost fraction; null: light is scattered once
};

AUREOLE_PLUGIN(
    RoughConductor, "bsdf", "roughconductor",
    PluginDoc{
        "A rough metal in vacuum: microfacets that reflect as `conductor` does. Single scattering makes "
        "very rough metals dark. With `energy_preserving` light is scattered until it leaves, with the more "
        "saturated colour of several reflections, and a white metal loses no light. It reflects on the side "
        "of its normal and is black on the other; `twosided` makes both sides alike.",
        "B. Walter, S. Marschner, H. Li, K. Torrance, Microfacet models for refraction through rough "
        "surfaces, EGSR 2007; E. Heitz, Understanding the masking-shadowing function in microfacet-based "
        "BRDFs, JCGT 3(2), 2014; C. Kulla, A. Conty, Revisiting physically based shading at Imageworks, "
        "SIGGRAPH courses 2017",
        conductor_parameters({{"distribution", "string", "", "beckmann",
                               "distribution of the microfacet normals: beckmann or ggx"},
                              {"alpha", "texture", "", "0.1",
                               "roughness; for beckmann sqrt(2) times the RMS slope"},
                              {"alpha_u", "texture", "", "alpha",
                               "roughness along dp/du; give alpha_u and alpha_v instead of alpha"},
                              {"alpha_v", "texture", "", "alpha", "roughness perpendicular to dp/du"},
                              {"sample_visible", "boolean", "", "true",
                               "sample visible normals (less noise), not all normals"},
                              {"energy_preserving", "boolean", "", "the scene's, else false",
                               "add multiple scattering, which Mitsuba omits"}}),
        {R"(<bsdf type="roughconductor">
    <string name="material" value="Al"/>
    <string name="distribution" value="ggx"/>
    <float name="alpha_u" value="0.05"/>
    <float name="alpha_v" value="0.3"/>
</bsdf>)",
         R"(<bsdf type="roughconductor">
    <spectrum name="eta" value="400:1.5, 550:0.4, 700:0.15"/>
    <spectrum name="k" value="400:1.9, 550:2.6, 700:4.0"/>
    <float name="specular_reflectance" value="0.8"/>
    <float name="alpha" value="0.4"/>
    <boolean name="sample_visible" value="false"/>
    <boolean name="energy_preserving" value="true"/>
</bsdf>)"}});

}  // namespace
}  // namespace aureole
