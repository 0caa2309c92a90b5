// SPDX-License-Identifier: Apache-2.0
// Rough diffuse surfaces: V-shaped grooves of Lambertian facets, with masking, shadowing and one
// interreflection (Oren & Nayar 1994). There is the full model, whose functions are fits to numerical
// integrals, and the qualitative one.
#include <cmath>

#include "aureole/bsdf/bsdf.h"
#include "aureole/bsdf/parameter/scalar_texture.h"
#include "aureole/math/warp.h"
#include "aureole/plugin/registry.h"

namespace aureole {
namespace {

class OrenNayar final : public Bsdf {
public:
  explicit OrenNayar(const Properties& properties)
      : Bsdf(properties),
        reflectance_(get_texture(properties, "reflectance", 0.5, SpectrumRole::reflectance)),
        alpha_(ScalarTexture::from(properties, "alpha", 0.2, Range::non_negative())),
        sigma_(ScalarTexture::from(properties, "sigma", 0, {0, 90})),
        has_sigma_(properties.has("sigma")),
        qualitative_(properties.get_bool("use_fast_approx", false)) {
    if (has_sigma_ && properties.has("alpha"))
      throw properties.error("sigma", "give either alpha or sigma, not both");
  }

  BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    if (!(wi.z > 0 && wo.z > 0)) return {};
    const float pdf = cosine_hemisphere_pdf(wo.z);
    const float s2 = variance(ctx);
    const Spectrum rho = reflectance_->eval(ctx.point, ctx.wavelengths);
    return {(qualitative_ ? rho * qualitative(wi, wo, s2) : full(wi, wo, s2, rho)) * pdf, Spectrum(pdf)};
  }

  std::optional<BsdfSample> sample(const Vec3& wi, float, Vec2 u2, const BsdfContext& ctx) const override {
    if (!(wi.z > 0)) return {};
    const Vec3 wo = square_to_cosine_hemisphere(u2);
    const BsdfEval e = eval_pdf(wi, wo, ctx);
    return BsdfSample{wo, e.value, e.pdf, lobes()};
  }

  bool needs_tangent() const override { return false; }
  Lobe lobes() const override { return Lobe::diffuse | Lobe::reflect; }

private:
  /// Returns sigma^2 in rad^2. A Gaussian surface of RMS slope alpha has the slope alpha/sqrt(2) across a
  /// groove.
  float variance(const BsdfContext& ctx) const {
    if (!has_sigma_) {
      const float alpha = alpha_.eval(ctx);
      return 0.5f * alpha * alpha;
    }
    const float sigma = sigma_.eval(ctx) * (kPi / 180);
    return sigma * sigma;
  }

  struct Azimuth {
    float sin_i, sin_o, cos_phi;
  };
  static Azimuth azimuth(const Vec3& wi, const Vec3& wo) {
    const float si = std::hypot(wi.x, wi.y), so = std::hypot(wo.x, wo.y), ss = si * so;
    const float dot_xy = wi.x * wo.x + wi.y * wo.y;
    // Along the normal the azimuth is undefined; all terms that depend on it vanish there.
    return {si, so, ss > 0 ? std::clamp(dot_xy / ss, -1.f, 1.f) : 0};
  }

  /// Returns pi f / rho, without interreflections.
  static float qualitative(const Vec3& wi, const Vec3& wo, float s2) {
    const float a = 1 - 0.5f * s2 / (s2 + 0.33f), b = 0.45f * s2 / (s2 + 0.09f);
    // Term sin(larger angle) tan(smaller angle) cos(phi).
    const float c = (wi.x * wo.x + wi.y * wo.y) / std::max(wi.z, wo.z);
    return a + b * std::max(c, 0.f);
  }

  /// Returns pi f: direct light and one interreflection, which is of second order in the reflectance.
  static Spectrum full(const Vec3& wi, const Vec3& wo, float s2, const Spectrum& rho) {
    const auto [sin_i, sin_o, cos_phi] = azimuth(wi, wo);
    const float cos_a = std::min(wi.z, wo.z), cos_b = std::max(wi.z, wo.z);
    const float sin_a = std::max(sin_i, sin_o), sin_b = std::min(sin_i, sin_o);
    const float alpha = std::atan2(sin_a, cos_a), beta = std::atan2(sin_b, cos_b);
    const float two_beta = 2 * kInvPi * beta, rough = s2 / (s2 + 0.09f);
    const float c1 = 1 - 0.5f * s2 / (s2 + 0.33f);
    const float c2 = 0.45f * rough * (sin_a - (cos_phi < 0 ? two_beta * two_beta * two_beta : 0));
    const float ab = 4 * alpha * beta * kInvPi * kInvPi, c3 = 0.125f * rough * ab * ab;
    const float tan_half = (sin_a + sin_b) / (cos_a + cos_b);  // tangent of (alpha + beta)/2
    const float direct = c1 + cos_phi * c2 * (sin_b / cos_b) + (1 - std::abs(cos_phi)) * c3 * tan_half;
    const float again = 0.17f * s2 / (s2 + 0.13f) * (1 - cos_phi * two_beta * two_beta);
    // The fits become negative for very rough surfaces near grazing angles.
    return max(rho * (Spectrum(direct) + rho * again), 0.f);
  }

  TexturePtr reflectance_;
  ScalarTexture alpha_, sigma_;
  bool has_sigma_, qualitative_;
};

AUREOLE_PLUGIN(
    OrenNayar, "bsdf", "oren_nayar",
    PluginDoc{
        "A rough diffuse surface, such as plaster, clay or the moon: brighter than a Lambertian one towards "
        "the light and at the rim, and flatter in between. The full model includes light that grooves "
        "reflect onto themselves, which makes rough colours more saturated; the qualitative one "
        "(use_fast_approx) omits it and is darker. Its functions are fits: a white surface gains up to 5 % "
        "(qualitative: 2 %) of energy at grazing angles. Roughness 0 is `diffuse`. It reflects on the side "
        "of its normal and is black on the other; `twosided` makes both sides alike. It is `roughdiffuse` "
        "of Mitsuba 0.6.",
        "M. Oren, S. K. Nayar, Generalization of Lambert's reflectance model, SIGGRAPH 1994",
        {{"reflectance", "texture", "", "0.5", "reflectance of a facet"},
         {"alpha", "texture", "", "0.2",
          "RMS slope of the surface, the roughness of Beckmann's distribution; sigma is alpha/sqrt(2) "
          "radians"},
         {"sigma", "texture", "degree", "none",
          "standard deviation of the angle between a facet and the surface, instead of alpha"},
         {"use_fast_approx", "boolean", "", "false", "use the qualitative model"}},
        {R"(<bsdf type="oren_nayar">
    <rgb name="reflectance" value="0.7, 0.5, 0.35"/>
    <float name="alpha" value="0.5"/>
</bsdf>)",
         R"(<bsdf type="oren_nayar">
    <float name="sigma" value="20"/>
    <boolean name="use_fast_approx" value="true"/>
</bsdf>)"}});

}  // namespace
}  // namespace aureole
