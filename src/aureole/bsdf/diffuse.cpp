// SPDX-License-Identifier: Apache-2.0
// An ideally diffuse surface, f = reflectance/pi, seen from the side of its normal only.
#include "aureole/bsdf/bsdf.h"
#include "aureole/math/warp.h"
#include "aureole/plugin/registry.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

class Diffuse final : public Bsdf {
public:
  explicit Diffuse(const Properties& properties)
      : Bsdf(properties),
        reflectance_(get_texture(properties, "reflectance", 0.5, SpectrumRole::reflectance)) {}

  BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    if (!(wi.z > 0 && wo.z > 0)) return {};
    const float pdf = cosine_hemisphere_pdf(wo.z);
    return {reflectance_->eval(ctx.point, ctx.wavelengths) * pdf, pdf};
  }

  std::optional<BsdfSample> sample(const Vec3& wi, float, Vec2 u2, const BsdfContext& ctx) const override {
    std::optional<BsdfSample> result;
    if (!(wi.z > 0)) return result;
    BsdfSample& s = result.emplace();
    s.wo = square_to_cosine_hemisphere(u2);
    const float pdf = cosine_hemisphere_pdf(s.wo.z);
    s.value = reflectance_->eval(ctx.point, ctx.wavelengths) * pdf;
    s.pdf = pdf;
    s.lobe = lobes();
    return result;
  }

  bool needs_tangent() const override { return false; }
  bool needs_choice() const override { return false; }
  bool is_constant() const override { return reflectance_->is_constant(); }
  Lobe lobes() const override { return Lobe::diffuse | Lobe::reflect; }

private:
  TexturePtr reflectance_;
};

AUREOLE_PLUGIN(
    Diffuse, "bsdf", "diffuse",
    PluginDoc{
        "An ideally diffuse (Lambertian) surface. It reflects on the side of its normal and is black on "
        "the other; `twosided` makes both sides alike.",
        "J. H. Lambert, Photometria, 1760",
        {{"reflectance", "texture", "", "0.5", "fraction of the light that is reflected"}},
        {R"(<bsdf type="diffuse">
    <rgb name="reflectance" value="0.2, 0.25, 0.7"/>
</bsdf>)"}});

}  // namespace
}  // namespace aureole
