// SPDX-License-Identifier: Apache-2.0
// A linear blend of two BSDFs, f = (1 - w) f_0 + w f_1.
#include <algorithm>

#include "aureole/bsdf/nested/nested_bsdfs.h"
#include "aureole/plugin/registry.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

class BlendBsdf final : public Bsdf {
public:
  explicit BlendBsdf(const Properties& properties)
      : Bsdf(properties), weight_(get_fraction(properties, "weight", {})) {
    const std::vector<BsdfPtr> nested = nested_bsdfs(properties, 2);
    for (const int k : {0, 1}) nested_[k] = nested[std::size_t(k)];
    if (weight_->minimum() < 1) lobes_ = nested_[0]->lobes();
    if (weight_->maximum() > 0) lobes_ = lobes_ | nested_[1]->lobes();
  }

  BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    BsdfEval sum;
    const float w = weight_at(ctx.point);
    add(sum, 0, 1 - w, wi, wo, ctx);
    add(sum, 1, w, wi, wo, ctx);
    return sum;
  }

  std::optional<BsdfSample> sample(const Vec3& wi, float u1, Vec2 u2, const BsdfContext& ctx) const override {
    const float w = weight_at(ctx.point);
    const int drawn = u1 < w ? 1 : 0;
    const float share = drawn ? w : 1 - w;
    auto s = nested_[drawn]->sample(wi, drawn ? remap_below(u1, w) : remap_above(u1, w), u2, ctx);
    if (!s) return s;
    s->value *= share, s->pdf *= share;
    // a delta sample has a probability (mass), which cannot be combined with the other BSDF's pdf
    if (s->is_delta()) return s;
    BsdfEval sum{s->value, s->pdf};
    add(sum, 1 - drawn, 1 - share, wi, s->wo, ctx);
    s->value = sum.value, s->pdf = sum.pdf;
    return s;
  }

  Spectrum null_transmittance(const Vec3& wi, const BsdfContext& ctx) const override {
    const float w = weight_at(ctx.point);
    Spectrum sum = 0.f;
    if (nested_[0]->is_passable()) sum += nested_[0]->null_transmittance(wi, ctx) * (1 - w);
    if (nested_[1]->is_passable()) sum += nested_[1]->null_transmittance(wi, ctx) * w;
    return sum;
  }

  Spectrum diffuse_reflectance(const Vec3& wi, const BsdfContext& ctx) const override {
    return lerp(nested_[0]->diffuse_reflectance(wi, ctx), nested_[1]->diffuse_reflectance(wi, ctx),
                weight_at(ctx.point));
  }

  double single_scattering_loss(bool from_within) const override {
    return std::max(nested_[0]->single_scattering_loss(from_within),
                    nested_[1]->single_scattering_loss(from_within));
  }
  bool interior_index(const Wavelengths& w, Spectrum& n) const override {
    Spectrum other;
    return nested_[0]->interior_index(w, n) && nested_[1]->interior_index(w, other) && !any(n.v != other.v);
  }
  bool needs_tangent() const override { return nested_[0]->needs_tangent() || nested_[1]->needs_tangent(); }
  Lobe lobes() const override { return lobes_; }

private:
  float weight_at(const SurfacePoint& point) const {
    return std::clamp(weight_->eval_scalar(point), 0.f, 1.f);
  }
  void add(BsdfEval& sum, int k, float share, const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const {
    if (!(share > 0)) return;
    const BsdfEval e = nested_[k]->eval_pdf(wi, wo, ctx);
    sum.value += e.value * share;
    sum.pdf += e.pdf * share;
  }

  TexturePtr weight_;
  BsdfPtr nested_[2];
  Lobe lobes_ = Lobe::none;
};

AUREOLE_PLUGIN(BlendBsdf, "bsdf", "blendbsdf",
               PluginDoc{
                   "A linear mixture of two BSDFs, weighted by a number or a texture: rust on metal, dirt on "
                   "paint. The weight does not depend on the wavelength: of a colour the luminance is used.",
                   "",
                   {{"weight", "texture", "", "required",
                     "weight of the second BSDF, in [0, 1]: 0 is the first alone, 1 the second"},
                    {"bsdf", "bsdf", "", "required", "two nested BSDFs"}},
                   {R"(<bsdf type="blendbsdf">
    <float name="weight" value="0.3"/>
    <bsdf type="conductor">
        <string name="material" value="Cu"/>
    </bsdf>
    <bsdf type="diffuse"/>
</bsdf>)",
                    R"(<bsdf type="blendbsdf">
    <texture name="weight" type="bitmap">
        <string name="filename" value="ramp.png"/>
        <boolean name="raw" value="true"/>
    </texture>
    <bsdf type="plastic"/>
    <bsdf type="mask">
        <bsdf type="diffuse"/>
    </bsdf>
</bsdf>)"}});

}  // namespace
}  // namespace aureole
