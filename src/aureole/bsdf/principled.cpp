// SPDX-License-Identifier: Apache-2.0
// Burley's principled BSDF as in Mitsuba 3.9: diffuse, sheen, metallic and dielectric GGX reflection, GGX
// refraction, and a clearcoat. Its pdfs do not depend on the wavelength, since all weights are numbers.
#include <cmath>

#include "aureole/bsdf/bsdf.h"
#include "aureole/bsdf/microfacet/ggx.h"
#include "aureole/bsdf/microfacet/microfacet_energy.h"
#include "aureole/bsdf/microfacet/principled_lobes.h"
#include "aureole/bsdf/parameter/scalar_texture.h"
#include "aureole/plugin/registry.h"
#include "aureole/spectrum/fresnel.h"

namespace aureole {
namespace {

/// The clearcoat: GTR with exponent 1 (Burley 2012, appendix B), and Smith masking of a fixed roughness.
struct Clearcoat {
  float alpha;

  explicit Clearcoat(float gloss) : alpha(0.1f + (0.001f - 0.1f) * gloss) {}

  float d(const Vec3& m) const {
    const float a2 = alpha * alpha, s2 = m.x * m.x + m.y * m.y;
    return (a2 - 1) / (kPi * std::log(a2) * (s2 + a2 * m.z * m.z));
  }
  /// Samples with density d(m) m.z.
  Vec3 sample(Vec2 u) const {
    const float a2 = alpha * alpha, power = std::pow(a2, 1 - u.y), scale = 1 / (1 - a2);
    const float s = std::sqrt(std::max((power - a2) * scale, 0.f));
    const Vec2 a = cos_sin_2pi(u.x);
    return {s * a.x, s * a.y, std::sqrt(std::max((1 - power) * scale, 0.f))};
  }
  static float g1(const Vec3& v) { return Ggx{0.25f, 0.25f}.g1(v); }
};

class Principled final : public Bsdf {
public:
  explicit Principled(const Properties& properties)
      : Bsdf(properties),
        base_color_(properties),
        roughness_(principled::unit(properties, "roughness", 0.5)),
        anisotropic_(principled::unit(properties, "anisotropic", 0)),
        metallic_(principled::unit(properties, "metallic", 0)),
        spec_trans_(principled::unit(properties, "spec_trans", 0)),
        spec_tint_(principled::unit(properties, "spec_tint", 0)),
        sheen_(principled::unit(properties, "sheen", 0)),
        sheen_tint_(principled::unit(properties, "sheen_tint", 0)),
        flatness_(principled::unit(properties, "flatness", 0)),
        clearcoat_(principled::unit(properties, "clearcoat", 0)),
        clearcoat_gloss_(principled::unit(properties, "clearcoat_gloss", 0)),
        diffuse_rate_(principled::rate(properties, "diffuse_reflectance_sampling_rate")),
        specular_rate_(principled::rate(properties, "main_specular_sampling_rate")),
        clearcoat_rate_(principled::rate(properties, "clearcoat_sampling_rate")),
        transmits_(spec_trans_.maximum() > 0) {
    // For matched indices there is no interface to refract; like Mitsuba, the index is changed to 1.001.
    if (properties.has("eta") && properties.has("specular"))
      throw properties.error("specular", "give either eta or specular, not both");
    if (properties.has("eta")) {
      eta_ = float(properties.get_float("eta", Range::positive()));
      if (transmits_ && eta_ == 1) eta_ = 1.001f;
    } else {
      double specular = properties.get_float("specular", 0.5, Range::unit());
      if (transmits_ && specular == 0) specular = 1e-3;
      eta_ = float(2 / (1 - std::sqrt(0.08 * specular)) - 1);
    }
  }

  BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    if (!(std::abs(wi.z) > 0 && std::abs(wo.z) > 0)) return {};
    const State s(*this, wi, ctx);
    if (!s.active()) return {};
    return s.front == (wo.z > 0) ? reflected(s, wi, wo, ctx) : transmitted(s, wi, wo, ctx);
  }

  std::optional<BsdfSample> sample(const Vec3& wi, float u1, Vec2 u2, const BsdfContext& ctx) const override {
    if (!(std::abs(wi.z) > 0)) return {};
    const State s(*this, wi, ctx);
    if (!s.active()) return {};
    float u = u1 * s.total;
    Vec3 wo;
    Lobe lobe = Lobe::glossy | Lobe::reflect;
    if (u < s.p_diffuse) {
      wo = square_to_cosine_hemisphere(u2);
      lobe = Lobe::diffuse | Lobe::reflect;
    } else if (u -= s.p_diffuse; u < s.p_clearcoat) {
      const Vec3 m = Clearcoat(clearcoat_gloss_.eval(ctx)).sample(u2);
      wo = m * (2 * dot(wi, m)) - wi;
    } else {
      const Vec3 seen = s.front ? wi : -wi;
      Vec3 m = s.ggx.sample_visible(seen, u2);
      const float c = std::min(dot(seen, m), 1.f);
      if (!(c > 0)) return {};
      if (!s.front) m = -m;
      const DielectricFresnel f = fresnel_dielectric(c, s.eta);
      // On the inside the Fresnel term alone decides, and there are no other lobes.
      const float transmit = (s.front ? s.bsdf : 1) * (1 - f.reflectance);
      if ((u - s.p_clearcoat) < transmit * s.p_specular) {
        wo = m * (c / s.eta - f.cos_t) - wi * (1 / s.eta);
        lobe = Lobe::glossy | Lobe::transmit;
      } else
        wo = m * (2 * c) - wi;
    }
    const bool through = has(lobe, Lobe::transmit);
    if (!(through == (wi.z * wo.z < 0)) || wo.z == 0) return {};
    wo = normalize(wo);
    const BsdfEval e = eval_pdf(wi, wo, ctx);
    if (!(e.pdf[0] > 0)) return {};
    return BsdfSample{wo, e.value, e.pdf, lobe, through ? s.eta : 1};
  }

  Spectrum diffuse_reflectance(const Vec3&, const BsdfContext& ctx) const override {
    return base_color_.eval(ctx);
  }

  double single_scattering_loss(bool from_within) const override {
    if (!transmits_ || properties().context().energy_preserving == false) return 0;
    const Ggx g = principled::distribution(roughness_.maximum(), anisotropic_.maximum());
    const double transmitting = double(spec_trans_.maximum()) * (1 - double(metallic_.minimum()));
    return transmitting * loss_({NormalDistribution::ggx, g.alpha_x, g.alpha_y}, eta_, from_within);
  }

  bool interior_index(const Wavelengths&, Spectrum& n) const override {
    n = eta_;
    return transmits_;
  }
  bool needs_tangent() const override { return anisotropic_.maximum() > 0; }
  Lobe lobes() const override {
    const Lobe reflected = Lobe::diffuse | Lobe::glossy | Lobe::reflect;
    return transmits_ ? reflected | Lobe::transmit : reflected;
  }

private:
  /// Quantities that depend only on the point and the side of wi.
  struct State {
    bool front;
    float eta;  ///< index beyond the surface over the index on the side of wi
    float roughness, metallic, clearcoat;
    float brdf, bsdf;  ///< weights of the diffuse and of the transmitting lobes
    Ggx ggx;
    /// probabilities of the lobes; `total` is the sum of the others
    float p_diffuse, p_clearcoat, p_specular, total;

    State(const Principled& p, const Vec3& wi, const BsdfContext& ctx)
        : front(wi.z > 0),
          eta(front ? p.eta_ : 1 / p.eta_),
          roughness(p.roughness_.eval(ctx)),
          metallic(p.metallic_.eval(ctx)),
          clearcoat(p.clearcoat_.eval(ctx)),
          ggx(principled::distribution(roughness, p.anisotropic_.eval(ctx))) {
      const float spec_trans = p.spec_trans_.eval(ctx);
      brdf = (1 - metallic) * (1 - spec_trans);
      bsdf = (1 - metallic) * spec_trans;
      p_diffuse = front ? brdf * p.diffuse_rate_ : 0;
      p_clearcoat = front ? 0.25f * clearcoat * p.clearcoat_rate_ : 0;
      p_specular = front ? p.specular_rate_ : 1;
      total = p_diffuse + p_clearcoat + p_specular;
    }
    /// Whether there are lobes: the inside is black if nothing transmits.
    bool active() const { return (front || bsdf > 0) && total > 0; }
  };

  BsdfEval reflected(const State& s, const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const {
    const auto [h, c] = principled::half_vector(wi, wo);
    if (!(c > 0)) return {};
    const float f = fresnel_dielectric(c, s.eta).reflectance;
    const float d = 0.25f * s.ggx.d(h) * s.ggx.g1_over_cos(wi), specular = d * s.ggx.g1(wo);
    if (!s.front) return {Spectrum(s.bsdf * f * specular), Spectrum(f * d)};

    const float cos_i = wi.z, cos_o = wo.z;
    const Spectrum color = base_color_.eval(ctx);
    const float spec_tint = spec_tint_.eval(ctx), sheen = (1 - s.metallic) * sheen_.eval(ctx);
    const float sheen_tint = sheen > 0 ? sheen_tint_.eval(ctx) : 0;
    const bool tinted = spec_tint > 0 || sheen_tint > 0;
    const Spectrum tint = tinted ? base_color_.tint(color, ctx) : Spectrum(1.f);

    BsdfEval e;
    // As in Mitsuba, without an interface (eta = 1) there is no reflection, not even from metals.
    if (f > 0) {
      Spectrum fresnel((1 - s.metallic) * (1 - spec_tint) * f);
      if (s.metallic > 0) fresnel += s.metallic * principled::schlick(color, c, s.eta);
      if (spec_tint > 0)
        fresnel += (1 - s.metallic) * spec_tint *
                   principled::schlick(tint * principled::normal_reflectance(s.eta), c, s.eta);
      e.value += fresnel * specular;
    }
    if (s.brdf > 0)
      e.value += color * (s.brdf * cos_o * kInvPi *
                          principled::diffuse(cos_i, cos_o, c, s.roughness, flatness_.eval(ctx)));
    if (sheen > 0) e.value += lerp(1.f, tint, sheen_tint) * (sheen * principled::schlick_weight(c) * cos_o);

    float pdf = s.p_diffuse * cosine_hemisphere_pdf(cos_o) + s.p_specular * (1 - s.bsdf * (1 - f)) * d;
    if (s.clearcoat > 0) {
      const float coat_d = 0.25f * Clearcoat(clearcoat_gloss_.eval(ctx)).d(h);
      const float coat_f = principled::schlick(0.04f, c, s.eta)[0];
      e.value += Spectrum(s.clearcoat * coat_f * coat_d * Clearcoat::g1(wi) * Clearcoat::g1(wo) * cos_o);
      pdf += s.p_clearcoat * coat_d * h.z / c;
    }
    e.pdf = pdf / s.total;
    return e;
  }

  BsdfEval transmitted(const State& s, const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const {
    if (!(s.bsdf > 0)) return {};
    Vec3 m = wi + wo * s.eta;
    const float length2 = length_squared(m);
    if (!(length2 > 1e-30f)) return {};
    // The normal on the side of wi must face wi, and wo must be on its other side.
    m = m * (1 / std::copysign(std::sqrt(length2), m.z * wi.z));
    const float c_i = std::min(dot(wi, m), 1.f), c_o = -dot(wo, m);
    if (!(c_i > 0 && c_o > 0)) return {};
    const float f = fresnel_dielectric(c_i, s.eta).reflectance;
    if (!(f < 1)) return {};
    // Value by B. Walter et al. 2007, equations 17 and 21.
    const float d = s.ggx.d(m) * s.ggx.g1_over_cos(wi) * c_i * s.eta * s.eta * c_o / length2;
    float value = s.bsdf * (1 - f) * d * s.ggx.g1(wo);
    if (ctx.mode == TransportMode::radiance) value *= 1 / (s.eta * s.eta);
    const float p = (s.front ? s.p_specular * s.bsdf : 1) * (1 - f) / s.total;
    return {sqrt(base_color_.eval(ctx)) * value, Spectrum(p * d)};
  }

  principled::BaseColor base_color_;
  ScalarTexture roughness_, anisotropic_, metallic_, spec_trans_, spec_tint_, sheen_, sheen_tint_, flatness_,
      clearcoat_, clearcoat_gloss_;
  float diffuse_rate_, specular_rate_, clearcoat_rate_;
  bool transmits_;
  float eta_ = 1;  // index of refraction of the interior over that of the exterior
  DiffuseLoss loss_;
};

AUREOLE_PLUGIN(
    Principled, "bsdf", "principled",
    PluginDoc{
        "Burley's principled (Disney) BSDF: few parameters, most of them in [0, 1], for metals, plastics, "
        "cloth, coated paint and rough glass. It is designed for appearance, not physics: diffuse "
        "reflection, sheen and clearcoat are added, so that it can reflect more light than it receives at "
        "grazing angles, and with roughness it loses light scattered between microfacets. It is reciprocal. "
        "Without spec_trans it is black from behind; `twosided` makes both sides alike. With specular = 0 "
        "or eta = 1 and no spec_trans nothing reflects but the diffuse lobe, sheen and clearcoat, metals "
        "included. The tints divide base_color by its luminance under D65 (the mean over the sensor's range "
        "if that includes no visible light).",
        "B. Burley, Physically based shading at Disney, SIGGRAPH 2012 course notes; B. Burley, Extending "
        "the Disney BRDF to a BSDF with integrated subsurface scattering, SIGGRAPH 2015 course notes; "
        "constants and lobes as in Mitsuba 3.9",
        {{"base_color", "texture", "", "0.5", "colour of the material; transmission uses its square root"},
         {"roughness", "texture", "", "0.5", "square root of the GGX width of reflection and transmission"},
         {"anisotropic", "texture", "", "0",
          "stretches highlights: the GGX widths are roughness^2/a along the tangent and roughness^2 a "
          "perpendicular to it, a^2 = 1 - 0.9 anisotropic"},
         {"metallic", "texture", "", "0", "fraction of metal, whose reflectance is base_color"},
         {"spec_trans", "texture", "", "0",
          "fraction of the non-metallic part that transmits as rough glass instead of being diffuse"},
         {"eta", "float", "", "none",
          "relative index of refraction, interior over exterior; instead of specular"},
         {"specular", "float", "", "0.5",
          "reflectance at normal incidence over 0.08; 0.5 is an index of 1.5"},
         {"spec_tint", "texture", "", "0",
          "fraction of the dielectric reflection that has the tint of base_color"},
         {"sheen", "texture", "", "0", "weight of a soft reflection at grazing angles, as of cloth"},
         {"sheen_tint", "texture", "", "0", "fraction of the sheen that has the tint of base_color"},
         {"flatness", "texture", "", "0",
          "fraction of the diffuse reflection that is an approximation of subsurface scattering"},
         {"clearcoat", "texture", "", "0", "weight of a second, colourless specular lobe"},
         {"clearcoat_gloss", "texture", "", "0",
          "sharpness of the clearcoat: a GTR width from 0.1 (0) to 0.001 (1)"},
         {"diffuse_reflectance_sampling_rate", "float", "", "1",
          "relative number of samples of the diffuse lobe; affects noise only"},
         {"main_specular_sampling_rate", "float", "", "1",
          "relative number of samples of the GGX lobes; affects noise only"},
         {"clearcoat_sampling_rate", "float", "", "1",
          "relative number of samples of the clearcoat; affects noise only"}},
        {R"(<bsdf type="principled">
    <rgb name="base_color" value="0.8, 0.3, 0.1"/>
    <float name="roughness" value="0.4"/>
    <float name="metallic" value="0.7"/>
    <float name="anisotropic" value="0.5"/>
    <float name="specular" value="0.6"/>
    <float name="spec_tint" value="0.4"/>
    <float name="sheen" value="0.3"/>
    <float name="sheen_tint" value="0.2"/>
    <float name="flatness" value="0.2"/>
    <float name="clearcoat" value="0.6"/>
    <float name="clearcoat_gloss" value="0.3"/>
    <float name="diffuse_reflectance_sampling_rate" value="0.5"/>
    <float name="main_specular_sampling_rate" value="2"/>
    <float name="clearcoat_sampling_rate" value="1"/>
</bsdf>)",
         R"(<bsdf type="principled">
    <rgb name="base_color" value="0.9, 0.95, 1"/>
    <float name="roughness" value="0.3"/>
    <float name="spec_trans" value="0.9"/>
    <float name="eta" value="1.5"/>
</bsdf>)"}});

}  // namespace
}  // namespace aureole
