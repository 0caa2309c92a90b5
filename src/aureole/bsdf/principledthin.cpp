// SPDX-License-Identifier: Apache-2.0
// Burley's principled BSDF for thin sheets as in Mitsuba 3.9: both faces are one surface without refraction;
// transmission is reflection mirrored to the other side. Both sides are alike.
#include <cmath>

#include "aureole/bsdf/bsdf.h"
#include "aureole/bsdf/microfacet/ggx.h"
#include "aureole/bsdf/microfacet/principled_lobes.h"
#include "aureole/bsdf/parameter/scalar_texture.h"
#include "aureole/plugin/registry.h"
#include "aureole/spectrum/fresnel.h"

namespace aureole {
namespace {

class PrincipledThin final : public Bsdf {
public:
  explicit PrincipledThin(const Properties& properties)
      : Bsdf(properties),
        base_color_(properties),
        roughness_(principled::unit(properties, "roughness", 0.5)),
        anisotropic_(principled::unit(properties, "anisotropic", 0)),
        spec_trans_(principled::unit(properties, "spec_trans", 0)),
        eta_(ScalarTexture::from(properties, "eta", 1.5, Range::positive())),
        spec_tint_(principled::unit(properties, "spec_tint", 0)),
        sheen_(principled::unit(properties, "sheen", 0)),
        sheen_tint_(principled::unit(properties, "sheen_tint", 0)),
        flatness_(principled::unit(properties, "flatness", 0)),
        diff_trans_(ScalarTexture::from(properties, "diff_trans", 0, {0, 2})),
        diffuse_reflectance_rate_(principled::rate(properties, "diffuse_reflectance_sampling_rate")),
        diffuse_transmittance_rate_(principled::rate(properties, "diffuse_transmittance_sampling_rate")),
        specular_reflectance_rate_(principled::rate(properties, "specular_reflectance_sampling_rate")),
        specular_transmittance_rate_(principled::rate(properties, "specular_transmittance_sampling_rate")) {}

  BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    if (!(std::abs(wi.z) > 0 && std::abs(wo.z) > 0)) return {};
    // The sheet is symmetric, so it is evaluated from its upper side.
    const Vec3 i = wi.z > 0 ? wi : -wi, o = wi.z > 0 ? wo : -wo;
    const State s(*this, ctx);
    if (!(s.total > 0)) return {};
    return o.z > 0 ? reflected(s, i, o, ctx) : transmitted(s, i, o, ctx);
  }

  std::optional<BsdfSample> sample(const Vec3& wi, float u1, Vec2 u2, const BsdfContext& ctx) const override {
    if (!(std::abs(wi.z) > 0)) return {};
    const Vec3 i = wi.z > 0 ? wi : -wi;
    const State s(*this, ctx);
    if (!(s.total > 0)) return {};
    float u = u1 * s.total;
    Vec3 o;
    Lobe lobe;
    if (u < s.p_specular_reflect) {
      const Vec3 m = s.ggx.sample_visible(i, u2);
      o = m * (2 * dot(i, m)) - i;
      if (!(o.z > 0)) return {};
      lobe = Lobe::glossy | Lobe::reflect;
    } else if (u -= s.p_specular_reflect; u < s.p_specular_transmit) {
      const Vec3 m = s.transmission_ggx().sample_visible(i, u2);
      o = m * (2 * dot(i, m)) - i;
      if (!(o.z > 0)) return {};
      o.z = -o.z;
      lobe = Lobe::glossy | Lobe::transmit;
    } else {
      u -= s.p_specular_transmit;
      const bool through = !(u < s.p_diffuse_reflect) && s.p_diffuse_transmit > 0;
      o = square_to_cosine_hemisphere(u2);
      if (through) o = -o;
      lobe = Lobe::diffuse | (through ? Lobe::transmit : Lobe::reflect);
    }
    const Vec3 wo = normalize(wi.z > 0 ? o : -o);
    const BsdfEval e = eval_pdf(wi, wo, ctx);
    if (!(e.pdf[0] > 0)) return {};
    return BsdfSample{wo, e.value, e.pdf, lobe};
  }

  Spectrum diffuse_reflectance(const Vec3&, const BsdfContext& ctx) const override {
    return base_color_.eval(ctx);
  }

  bool needs_tangent() const override { return anisotropic_.maximum() > 0; }
  Lobe lobes() const override {
    Lobe all = Lobe::diffuse | Lobe::reflect;
    if (spec_trans_.maximum() > 0) all = all | Lobe::glossy | Lobe::transmit;
    if (diff_trans_.maximum() > 0) all = all | Lobe::transmit;
    return all;
  }

private:
  struct State {
    /// parameters at the point; diff_trans is scaled to [0, 1]
    float roughness, anisotropic, spec_trans, eta, diff_trans;
    Ggx ggx;
    float p_specular_reflect, p_specular_transmit, p_diffuse_reflect, p_diffuse_transmit, total;

    State(const PrincipledThin& p, const BsdfContext& ctx)
        : roughness(p.roughness_.eval(ctx)),
          anisotropic(p.anisotropic_.eval(ctx)),
          spec_trans(p.spec_trans_.eval(ctx)),
          eta(p.eta_.eval(ctx)),
          diff_trans(0.5f * p.diff_trans_.eval(ctx)),
          ggx(principled::distribution(roughness, anisotropic)) {
      p_specular_reflect = 0.5f * spec_trans * p.specular_reflectance_rate_;
      p_specular_transmit = 0.5f * spec_trans * p.specular_transmittance_rate_;
      p_diffuse_reflect = (1 - spec_trans) * (1 - diff_trans) * p.diffuse_reflectance_rate_;
      p_diffuse_transmit = (1 - spec_trans) * diff_trans * p.diffuse_transmittance_rate_;
      total = p_specular_reflect + p_specular_transmit + p_diffuse_reflect + p_diffuse_transmit;
    }
    /// Two refractions spread light less than a reflection (Burley 2015, figure 15).
    Ggx transmission_ggx() const {
      return principled::distribution((0.65f * eta - 0.35f) * roughness, anisotropic);
    }
  };

  BsdfEval reflected(const State& s, const Vec3& i, const Vec3& o, const BsdfContext& ctx) const {
    const principled::Half half = principled::half_vector(i, o);
    if (!(half.c > 0)) return {};
    const Spectrum color = base_color_.eval(ctx);
    const float diffuse_weight = (1 - s.spec_trans) * (1 - s.diff_trans);
    const float spec_tint = spec_tint_.eval(ctx), sheen = diffuse_weight * sheen_.eval(ctx);
    const float sheen_tint = sheen > 0 ? sheen_tint_.eval(ctx) : 0;
    const bool tinted = (spec_tint > 0 && s.spec_trans > 0) || sheen_tint > 0;
    const Spectrum tint = tinted ? base_color_.tint(color, ctx) : Spectrum(1.f);

    BsdfEval e;
    float pdf = s.p_diffuse_reflect * cosine_hemisphere_pdf(o.z);
    if (s.spec_trans > 0) {
      Spectrum f(fresnel_dielectric(half.c, s.eta).reflectance);
      if (spec_tint > 0)
        f = lerp(f, principled::schlick(tint * principled::normal_reflectance(s.eta), half.c, s.eta),
                 spec_tint);
      const float d = 0.25f * s.ggx.d(half.h) * s.ggx.g1_over_cos(i);
      e.value += f * (s.spec_trans * d * s.ggx.g1(o));
      pdf += s.p_specular_reflect * d;
    }
    if (diffuse_weight > 0)
      e.value += color * (diffuse_weight * o.z * kInvPi *
                          principled::diffuse(i.z, o.z, half.c, s.roughness, flatness_.eval(ctx)));
    if (sheen > 0)
      e.value += lerp(1.f, tint, sheen_tint) * (sheen * principled::schlick_weight(half.c) * o.z);
    e.pdf = pdf / s.total;
    return e;
  }

  BsdfEval transmitted(const State& s, const Vec3& i, const Vec3& o, const BsdfContext& ctx) const {
    const Spectrum color = base_color_.eval(ctx);
    const float diffuse = (1 - s.spec_trans) * s.diff_trans * cosine_hemisphere_pdf(-o.z);
    BsdfEval e{color * diffuse, Spectrum(s.p_diffuse_transmit * cosine_hemisphere_pdf(-o.z) / s.total)};
    if (!(s.spec_trans > 0)) return e;
    const Vec3 mirrored{o.x, o.y, -o.z};
    const principled::Half half = principled::half_vector(i, mirrored);
    if (!(half.c > 0)) return e;
    const Ggx ggx = s.transmission_ggx();
    const float d = 0.25f * ggx.d(half.h) * ggx.g1_over_cos(i);
    e.pdf += Spectrum(s.p_specular_transmit * d / s.total);
    // Mitsuba omits directions on the wrong side of the half vector; Burley (2015) has no such condition. It
    // changes when directions are exchanged, so Mitsuba's model is not reciprocal, and importance mode tests
    // the exchanged directions.
    const Vec3& to = ctx.mode == TransportMode::radiance ? o : i;
    const float along = to.x * half.h.x + to.y * half.h.y;
    const bool visible =
        ctx.mode == TransportMode::radiance ? along + to.z * half.h.z < 0 : along - to.z * half.h.z < 0;
    if (visible)
      e.value += color * (s.spec_trans * (1 - fresnel_dielectric(half.c, s.eta).reflectance) * d * ggx.g1(o));
    return e;
  }

  principled::BaseColor base_color_;
  ScalarTexture roughness_, anisotropic_, spec_trans_, eta_, spec_tint_, sheen_, sheen_tint_, flatness_,
      diff_trans_;
  float diffuse_reflectance_rate_, diffuse_transmittance_rate_, specular_reflectance_rate_,
      specular_transmittance_rate_;
};

AUREOLE_PLUGIN(
    PrincipledThin, "bsdf", "principledthin",
    PluginDoc{
        "Burley's principled (Disney) BSDF for thin sheets such as leaves, paper and panes, which are one "
        "surface without refraction; both sides are alike. It is designed for appearance, not physics: "
        "sheen adds to the diffuse reflection. Reflections between the two faces are omitted. Burley's "
        "rough transmission, reflection mirrored to the other side, is reciprocal. Mitsuba's, implemented "
        "here, omits directions on the wrong side of the half vector of the reflection, a condition that "
        "changes when directions are exchanged: light passes from 85 to 60 degrees, but not from 60 to 85.",
        "B. Burley, Extending the Disney BRDF to a BSDF with integrated subsurface scattering, SIGGRAPH "
        "2015 course notes; constants and lobes as in Mitsuba 3.9",
        {{"base_color", "texture", "", "0.5", "colour of the material"},
         {"roughness", "texture", "", "0.5",
          "square root of the GGX width of reflection; transmission has (0.65 eta - 0.35) times this "
          "roughness"},
         {"anisotropic", "texture", "", "0",
          "stretches highlights: the GGX widths are roughness^2/a along the tangent and roughness^2 a "
          "perpendicular to it, a^2 = 1 - 0.9 anisotropic"},
         {"spec_trans", "texture", "", "0",
          "fraction of specular reflection and transmission; the rest is diffuse"},
         {"eta", "texture", "", "1.5", "relative index of refraction, sheet over exterior"},
         {"spec_tint", "texture", "", "0",
          "fraction of the specular reflection that has the tint of base_color"},
         {"sheen", "texture", "", "0", "weight of a soft reflection at grazing angles, as of cloth"},
         {"sheen_tint", "texture", "", "0", "fraction of the sheen that has the tint of base_color"},
         {"flatness", "texture", "", "0",
          "fraction of the diffuse reflection that is an approximation of subsurface scattering"},
         {"diff_trans", "texture", "", "0",
          "transmission of diffuse light: 0 none, 1 half of it, 2 all of it"},
         {"diffuse_reflectance_sampling_rate", "float", "", "1",
          "relative number of samples of diffuse reflection; affects noise only"},
         {"diffuse_transmittance_sampling_rate", "float", "", "1",
          "relative number of samples of diffuse transmission; affects noise only"},
         {"specular_reflectance_sampling_rate", "float", "", "1",
          "relative number of samples of specular reflection; affects noise only"},
         {"specular_transmittance_sampling_rate", "float", "", "1",
          "relative number of samples of specular transmission; affects noise only"}},
        {R"(<bsdf type="principledthin">
    <rgb name="base_color" value="0.7, 0.1, 0.1"/>
    <float name="roughness" value="0.35"/>
    <float name="anisotropic" value="0.5"/>
    <float name="spec_trans" value="0.6"/>
    <float name="eta" value="1.33"/>
    <float name="spec_tint" value="0.1"/>
    <float name="diff_trans" value="0.3"/>
</bsdf>)",
         R"(<bsdf type="principledthin">
    <rgb name="base_color" value="0.3, 0.6, 0.2"/>
    <float name="sheen" value="0.3"/>
    <float name="sheen_tint" value="0.5"/>
    <float name="flatness" value="0.5"/>
    <float name="diff_trans" value="1.2"/>
    <float name="diffuse_reflectance_sampling_rate" value="1"/>
    <float name="diffuse_transmittance_sampling_rate" value="2"/>
    <float name="specular_reflectance_sampling_rate" value="1"/>
    <float name="specular_transmittance_sampling_rate" value="1"/>
</bsdf>)"}});

}  // namespace
}  // namespace aureole
