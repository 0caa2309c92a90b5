// SPDX-License-Identifier: Apache-2.0
// The modified Phong model: a diffuse lobe and a glossy one around the mirror direction,
//     f = rho_d/pi + rho_s (n + 2)/(2 pi) cos^n(angle to the mirror direction).
#include <cmath>

#include "aureole/bsdf/bsdf.h"
#include "aureole/bsdf/parameter/diffuse_specular.h"
#include "aureole/bsdf/parameter/scalar_texture.h"
#include "aureole/math/warp.h"
#include "aureole/plugin/registry.h"

namespace aureole {
namespace {

class Phong final : public Bsdf {
public:
  explicit Phong(const Properties& properties)
      : Bsdf(properties),
        colors_(properties),
        exponent_(ScalarTexture::from(properties, "exponent", 30, Range::non_negative())) {}

  BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    if (!(wi.z > 0 && wo.z > 0)) return {};
    return evaluate(wi, wo, colors_.at(ctx), exponent_.eval(ctx));
  }

  std::optional<BsdfSample> sample(const Vec3& wi, float u1, Vec2 u2, const BsdfContext& ctx) const override {
    if (!(wi.z > 0)) return {};
    const DiffuseSpecular::Colors colors = colors_.at(ctx);
    const float n = exponent_.eval(ctx);
    const bool specular = u1 < colors.specular_probability;
    Vec3 wo;
    if (specular) {
      const float c = std::pow(1 - u2.x, 1 / (n + 1)), s = std::sqrt((1 - c) * (1 + c));
      const Vec2 a = cos_sin_2pi(u2.y);
      wo = normalize(Frame::from_normal(reflect(wi)).to_world({s * a.x, s * a.y, c}));
      if (!(wo.z > 0)) return {};
    } else
      wo = square_to_cosine_hemisphere(u2);
    const BsdfEval e = evaluate(wi, wo, colors, n);
    if (!(e.pdf[0] > 0)) return {};
    return BsdfSample{wo, e.value, e.pdf, (specular ? Lobe::glossy : Lobe::diffuse) | Lobe::reflect};
  }

  bool needs_tangent() const override { return false; }
  Lobe lobes() const override { return Lobe::diffuse | Lobe::glossy | Lobe::reflect; }

private:
  static BsdfEval evaluate(const Vec3& wi, const Vec3& wo, const DiffuseSpecular::Colors& colors, float n) {
    const float diffuse = cosine_hemisphere_pdf(wo.z), p = colors.specular_probability;
    const float c = std::min(dot(reflect(wi), wo), 1.f);
    const float lobe = c > 0 ? 0.5f * kInvPi * std::pow(c, n) : 0;
    return {colors.diffuse * diffuse + colors.specular * ((n + 2) * lobe * wo.z),
            Spectrum((1 - p) * diffuse + p * (n + 1) * lobe)};
  }

  DiffuseSpecular colors_;
  ScalarTexture exponent_;
};

AUREOLE_PLUGIN(
    Phong, "bsdf", "phong",
    PluginDoc{
        "The modified Phong model: a diffuse lobe and a glossy one around the mirror direction. It is "
        "reciprocal. At normal incidence it reflects specular_reflectance + diffuse_reflectance, at other "
        "angles less: a sharp lobe falls with the cosine of the angle, a wide one to a third or a half, "
        "since the model has no microscopic surface. If the two reflectances add up to more than one, both "
        "are divided by their sum, with a note. It reflects on the side of its normal and is black on the "
        "other; `twosided` makes both sides alike.",
        "B. T. Phong, Illumination for computer generated pictures, CACM 18(6), 1975; E. P. Lafortune, Y. "
        "D. Willems, Using the modified Phong reflectance model for physically based rendering, report CW "
        "197, KU Leuven 1994",
        {{"exponent", "texture", "", "30", "sharpness of the glossy lobe, 0 or more"},
         {"specular_reflectance", "texture", "", "0.2", "reflectance of the glossy lobe at normal incidence"},
         {"diffuse_reflectance", "texture", "", "0.5", "reflectance of the diffuse lobe"}},
        {R"(<bsdf type="phong">
    <float name="exponent" value="50"/>
    <rgb name="specular_reflectance" value="0.3, 0.3, 0.2"/>
    <rgb name="diffuse_reflectance" value="0.1, 0.2, 0.6"/>
</bsdf>)"}});

}  // namespace
}  // namespace aureole
