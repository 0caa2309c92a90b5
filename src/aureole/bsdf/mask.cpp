// SPDX-License-Identifier: Apache-2.0
// A surface with holes: the opacity mixes a nested BSDF with a null interaction.
#include <algorithm>

#include "aureole/bsdf/nested/nested_bsdfs.h"
#include "aureole/plugin/registry.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

class Mask final : public Bsdf {
public:
  explicit Mask(const Properties& properties)
      : Bsdf(properties),
        opacity_(get_fraction(properties, "opacity", 0.5)),
        nested_(nested_bsdfs(properties, 1).front()) {
    // A mask whose opacity is 1 everywhere, or 0 everywhere, declares only the lobes of that case.
    if (opacity_->maximum() > 0) lobes_ = nested_->lobes();
    if (opacity_->minimum() < 1) lobes_ = lobes_ | kNullLobe;
  }

  BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    const float opacity = opacity_at(ctx.point);
    if (!(opacity > 0)) return {};
    const BsdfEval e = nested_->eval_pdf(wi, wo, ctx);
    return {e.value * opacity, e.pdf * opacity};
  }

  std::optional<BsdfSample> sample(const Vec3& wi, float u1, Vec2 u2, const BsdfContext& ctx) const override {
    const float opacity = opacity_at(ctx.point);
    if (!(u1 < opacity)) return null_sample(wi, 1 - opacity);
    auto s = nested_->sample(wi, remap_below(u1, opacity), u2, ctx);
    if (s) s->value *= opacity, s->pdf *= opacity;
    return s;
  }

  Spectrum null_transmittance(const Vec3& wi, const BsdfContext& ctx) const override {
    const float opacity = opacity_at(ctx.point);
    const Spectrum open = 1 - opacity;
    return nested_->is_passable() ? open + nested_->null_transmittance(wi, ctx) * opacity : open;
  }

  // Feature for denoisers: the reflectance of the opaque part, since the picture's alpha shows the opacity.
  Spectrum diffuse_reflectance(const Vec3& wi, const BsdfContext& ctx) const override {
    return nested_->diffuse_reflectance(wi, ctx);
  }
  Vec3 shading_normal(const SurfacePoint& point) const override { return nested_->shading_normal(point); }

  double single_scattering_loss(bool from_within) const override {
    return nested_->single_scattering_loss(from_within);
  }
  bool needs_tangent() const override { return nested_->needs_tangent(); }
  Lobe lobes() const override { return lobes_; }

private:
  float opacity_at(const SurfacePoint& point) const {
    return std::clamp(opacity_->eval_scalar(point), 0.f, 1.f);
  }

  TexturePtr opacity_;
  BsdfPtr nested_;
  Lobe lobes_ = Lobe::none;
};

AUREOLE_PLUGIN(
    Mask, "bsdf", "mask",
    PluginDoc{
        "Makes a BSDF partly transparent, or with a texture in some areas: leaves, fences, fabrics. Light "
        "that is not covered passes unchanged. This is not a path vertex: it does not count for "
        "`max_depth`, and light sampling passes through it. The opacity does not depend on the wavelength: "
        "of a colour the luminance is used.",
        "",
        {{"opacity", "texture", "", "0.5", "fraction of the surface that is covered, in [0, 1]"},
         {"bsdf", "bsdf", "", "required", "one nested BSDF"}},
        {R"(<bsdf type="mask">
    <float name="opacity" value="0.3"/>
    <bsdf type="diffuse"/>
</bsdf>)",
         R"(<bsdf type="mask">
    <texture name="opacity" type="checkerboard">
        <float name="color0" value="0"/>
        <float name="color1" value="1"/>
    </texture>
    <bsdf type="twosided">
        <bsdf type="plastic"/>
    </bsdf>
</bsdf>)"}});

}  // namespace
}  // namespace aureole
