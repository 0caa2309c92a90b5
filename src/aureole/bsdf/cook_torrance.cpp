// SPDX-License-Identifier: Apache-2.0
// The reflectance model of Cook and Torrance: a diffuse term and specular microfacets,
//     f = d rho/pi + s F D G / (k cos_i cos_o),   k = 4 or pi,
// with Beckmann's distribution D (normalised, one or two scales of roughness), the masking and shadowing of
// V-shaped grooves G = min(1, 2 (n.h)(n.wi)/(wi.h), 2 (n.h)(n.wo)/(wo.h)), and the Fresnel reflectance F at
// the half vector.
#include <cmath>

#include "aureole/bsdf/bsdf.h"
#include "aureole/bsdf/microfacet/beckmann.h"
#include "aureole/bsdf/parameter/scalar_texture.h"
#include "aureole/math/warp.h"
#include "aureole/plugin/registry.h"
#include "aureole/spectrum/fresnel.h"

namespace aureole {
namespace {

class CookTorrance final : public Bsdf {
public:
  explicit CookTorrance(const Properties& properties)
      : Bsdf(properties),
        alpha_(ScalarTexture::from(properties, "alpha", 0.2, Range::positive())),
        alpha_2_(ScalarTexture::from(properties, "alpha_2", 0.4, Range::positive())),
        weight_2_(ScalarTexture::from(properties, "weight_2", 0, Range::unit())),
        eta_(get_optional_texture(properties, "eta", SpectrumRole::unbounded)),
        k_(get_optional_texture(properties, "k", SpectrumRole::unbounded)),
        normal_reflectance_(
            get_optional_texture(properties, "specular_reflectance", SpectrumRole::reflectance)),
        diffuse_(get_texture(properties, "diffuse_reflectance", 0.5, SpectrumRole::reflectance)),
        s_(float(properties.get_float("specular", 0.5, Range::unit()))),
        d_(float(properties.get_float("diffuse", 1 - double(s_), Range::unit()))),
        // Factor 1/k of the equation above, times the 4 of the Jacobian of the half vector.
        scale_(properties.get_choice("denominator", "4", {"4", "pi"}) == "4" ? 1 : 4 * kInvPi) {
    if (s_ + d_ > 1 + 1e-6f)
      throw properties.error(properties.has("diffuse") ? "diffuse" : "specular",
                             "specular and diffuse are shares of the light: together at most 1");
    if (normal_reflectance_ && (eta_ || k_))
      throw properties.error("specular_reflectance",
                             "give either the reflectance at normal incidence or eta and k, not both");
    if (properties.has("alpha_2") && !properties.has("weight_2"))
      properties.note("alpha_2", "has no effect without weight_2");
    if (!eta_ && !normal_reflectance_) eta_ = get_texture(properties, "eta", 1.5, SpectrumRole::unbounded);
  }

  BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    if (!(wi.z > 0 && wo.z > 0)) return {};
    return evaluate(State(*this, wi.z, ctx), wi, wo);
  }

  std::optional<BsdfSample> sample(const Vec3& wi, float u1, Vec2 u2, const BsdfContext& ctx) const override {
    if (!(wi.z > 0)) return {};
    const State state(*this, wi.z, ctx);
    const bool specular = u1 < state.p_specular;
    Vec3 wo;
    if (specular) {
      const bool second = u1 < state.p_specular * state.weight_2;
      const Vec3 h = (second ? state.slopes_2 : state.slopes).sample(u2);
      const float c = dot(wi, h);
      wo = normalize(h * (2 * c) - wi);
      if (!(c > 0 && wo.z > 0)) return {};
    } else
      wo = square_to_cosine_hemisphere(u2);
    const BsdfEval e = evaluate(state, wi, wo);
    if (!(e.pdf[0] > 0)) return {};
    return BsdfSample{wo, e.value, e.pdf, (specular ? Lobe::glossy : Lobe::diffuse) | Lobe::reflect};
  }

  bool needs_tangent() const override { return false; }
  Lobe lobes() const override { return Lobe::diffuse | Lobe::glossy | Lobe::reflect; }

private:
  /// Quantities of one evaluation: all that depends on the point and the wavelengths, and the probability of
  /// each lobe.
  struct State {
    Beckmann slopes, slopes_2;
    float weight_2;
    Spectrum eta, k, diffuse;  ///< `diffuse` includes the factor d
    bool conductor;
    float p_specular, specular;

    State(const CookTorrance& p, float cos_i, const BsdfContext& ctx)
        : weight_2(p.weight_2_.eval(ctx)),
          diffuse(p.diffuse_->eval(ctx.point, ctx.wavelengths) * p.d_),
          conductor(p.k_ != nullptr),
          specular(p.s_ * p.scale_) {
      const float a = p.alpha_.eval(ctx), a2 = weight_2 > 0 ? p.alpha_2_.eval(ctx) : a;
      slopes = {a, a}, slopes_2 = {a2, a2};
      if (p.normal_reflectance_) {
        // Index of refraction of a medium without absorption that has this reflectance (Cook & Torrance
        // 1982).
        const Spectrum r = sqrt(min(p.normal_reflectance_->eval(ctx.point, ctx.wavelengths), 0.9999f));
        eta = (Spectrum(1.f) + r) / (Spectrum(1.f) - r);
      } else
        eta = p.eta_ ? p.eta_->eval(ctx.point, ctx.wavelengths) : Spectrum(0.f);
      if (conductor) k = p.k_->eval(ctx.point, ctx.wavelengths);
      // Lobes are chosen by their energy, averaged over the path's wavelengths, so that the probabilities do
      // not depend on the hero.
      const float s = specular * mean(fresnel(cos_i)), d = mean(diffuse);
      p_specular = s + d > 0 ? s / (s + d) : 0;
    }
    Spectrum fresnel(float c) const {
      return conductor ? fresnel_conductor(c, eta, k) : fresnel_dielectric(c, eta);
    }
  };

  static BsdfEval evaluate(const State& s, const Vec3& wi, const Vec3& wo) {
    const float cosine = cosine_hemisphere_pdf(wo.z);
    BsdfEval e{s.diffuse * cosine, Spectrum((1 - s.p_specular) * cosine)};
    Vec3 h = wi + wo;
    const float length2 = length_squared(h);
    if (!(s.specular > 0) || !(length2 > 1e-30f)) return e;
    const float length = std::sqrt(length2), c = std::min(0.5f * length, 1.f);
    h = h * (1 / length);
    float d = s.slopes.d(h);
    if (s.weight_2 > 0) d += s.weight_2 * (s.slopes_2.d(h) - d);
    // G / cos_i, finite at grazing incidence; it depends on the smaller cosine.
    const float groove = 2 * h.z / c;
    const float g_over_cos = std::min(1 / wi.z, groove * std::min(1.f, wo.z / wi.z));
    e.value += s.fresnel(c) * (0.25f * s.specular * d * g_over_cos);
    e.pdf += Spectrum(s.p_specular * d * h.z / (4 * c));
    return e;
  }

  ScalarTexture alpha_, alpha_2_, weight_2_;
  TexturePtr eta_, k_, normal_reflectance_, diffuse_;
  float s_, d_, scale_;
};

AUREOLE_PLUGIN(
    CookTorrance, "bsdf", "cook_torrance",
    PluginDoc{
        "The model of Cook and Torrance for metals and plastics: a diffuse term, and specular microfacets "
        "of Gaussian slopes in V-shaped grooves. It is reciprocal. With the denominator 4, which follows "
        "from the geometry, it never gains energy; rough surfaces lose light that is reflected more than "
        "once. The paper prints pi instead: 4/pi more light, so that smooth metals reflect up to 1.27 times "
        "what they receive. `roughconductor` has better masking. It reflects on the side of its normal and "
        "is black on the other; `twosided` makes both sides alike.",
        "R. L. Cook, K. E. Torrance, A reflectance model for computer graphics, ACM Transactions on "
        "Graphics 1(1), 1982; the 4 from K. E. Torrance, E. M. Sparrow, Theory for off-specular reflection "
        "from roughened surfaces, J. Opt. Soc. Am. 57(9), 1967, with a normalised distribution",
        {{"alpha", "texture", "", "0.2", "roughness m, the RMS slope of the facets"},
         {"alpha_2", "texture", "", "0.4", "a second scale of roughness"},
         {"weight_2", "texture", "", "0", "fraction of the facets that have alpha_2"},
         {"eta", "texture", "", "1.5", "index of refraction (if k is given, its real part, with default 0)"},
         {"k", "texture", "", "none", "imaginary part of the index; the surface is a conductor"},
         {"specular_reflectance", "texture", "", "none",
          "instead of eta and k: reflectance of a facet at normal incidence, from which an index is "
          "computed (up to 0.9999)"},
         {"specular", "float", "", "0.5", "fraction s of the specular term"},
         {"diffuse", "float", "", "1 - specular", "fraction d of the diffuse term"},
         {"diffuse_reflectance", "texture", "", "0.5", "reflectance rho of the diffuse term"},
         {"denominator", "string", "", "4", "4, or pi as printed in 1982"}},
        {R"(<bsdf type="cook_torrance">
    <float name="alpha" value="0.4"/>
    <float name="alpha_2" value="0.2"/>
    <float name="weight_2" value="0.6"/>
    <spectrum name="eta" value="400:1.2, 550:1, 700:0.2"/>
    <spectrum name="k" value="400:2.2, 550:2.6, 700:4"/>
    <float name="specular" value="1"/>
    <float name="diffuse" value="0"/>
</bsdf>)",
         R"(<bsdf type="cook_torrance">
    <float name="alpha" value="0.15"/>
    <float name="specular_reflectance" value="0.05"/>
    <float name="specular" value="0.1"/>
    <float name="diffuse" value="0.9"/>
    <rgb name="diffuse_reflectance" value="0.6, 0.1, 0.1"/>
    <string name="denominator" value="4"/>
</bsdf>)"}});

}  // namespace
}  // namespace aureole
