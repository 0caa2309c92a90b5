// SPDX-License-Identifier: Apache-2.0
// Makes one-sided BSDFs reflect on both sides of a surface: the local frame is flipped if wi is below.
#include "aureole/bsdf/mirror_reflection.h"
#include "aureole/plugin/registry.h"

namespace aureole {
namespace {

class TwoSided final : public Bsdf, public ReflectsAsNested {
public:
  explicit TwoSided(const Properties& properties) : Bsdf(properties) {
    const auto nested = properties.get_children<Bsdf>("bsdf");
    if (nested.empty() || nested.size() > 2)
      throw Error(properties.where(),
                  "\"twosided\" needs one or two nested BSDFs, got " + std::to_string(nested.size()));
    front_ = nested.front();
    back_ = nested.back();
    if (!properties.get_bool("allow_transmission", false) && has(lobes(), Lobe::transmit | Lobe::through))
      throw Error(properties.where(),
                  "\"twosided\" is for BSDFs that only reflect; a nested one transmits light, which has two "
                  "sides already");
  }

  BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    if (wi.z > 0) return front_->eval_pdf(wi, wo, ctx);
    if (wi.z < 0) return back_->eval_pdf(flip(wi), flip(wo), ctx);
    return {};
  }

  std::optional<BsdfSample> sample(const Vec3& wi, float u1, Vec2 u2, const BsdfContext& ctx) const override {
    if (wi.z > 0) return front_->sample(wi, u1, u2, ctx);
    if (!(wi.z < 0)) return {};
    auto s = back_->sample(flip(wi), u1, u2, ctx);
    if (s) s->wo = flip(s->wo);
    return s;
  }

  Spectrum diffuse_reflectance(const Vec3& wi, const BsdfContext& ctx) const override {
    return wi.z > 0 ? front_->diffuse_reflectance(wi, ctx) : back_->diffuse_reflectance(flip(wi), ctx);
  }

  Vec3 shading_normal(const SurfacePoint& point) const override { return front_->shading_normal(point); }

  bool needs_choice() const override { return front_->needs_choice() || (differ() && back_->needs_choice()); }
  bool is_constant() const override { return front_->is_constant() && back_->is_constant(); }
  bool needs_tangent() const override {
    return front_->needs_tangent() || (differ() && back_->needs_tangent());
  }
  Spectrum null_transmittance(const Vec3& wi, const BsdfContext& ctx) const override {
    if (wi.z > 0) return front_->is_passable() ? front_->null_transmittance(wi, ctx) : 0.f;
    if (wi.z < 0) return back_->is_passable() ? back_->null_transmittance(flip(wi), ctx) : 0.f;
    return 0.f;
  }

  const Bsdf* reflecting() const override { return differ() ? nullptr : front_.get(); }

  double single_scattering_loss(bool from_within) const override {
    // The back BSDF is turned around: light from within hits its outside.
    return (from_within ? back_ : front_)->single_scattering_loss(false);
  }
  Lobe lobes() const override { return differ() ? front_->lobes() | back_->lobes() : front_->lobes(); }

private:
  /// Whether front and back differ. Where they are the same BSDF, it is evaluated once: evaluating it twice
  /// would double the work with every level of nesting.
  bool differ() const { return front_ != back_; }
  static Vec3 flip(const Vec3& w) { return {w.x, w.y, -w.z}; }

  BsdfPtr front_, back_;
};

AUREOLE_PLUGIN(
    TwoSided, "bsdf", "twosided",
    PluginDoc{
        "Makes BSDFs that reflect on one side only reflect on both. With one nested BSDF both sides are "
        "alike; with two the first is for the side of the normal and the second for the other.",
        "",
        {{"bsdf", "bsdf", "", "required", "one or two nested BSDFs"},
         {"allow_transmission", "boolean", "", "false",
          "accept nested BSDFs that transmit light; their upper side is then used from both directions. The "
          "holes of a `mask` need no such permission"}},
        {R"(<bsdf type="twosided">
    <bsdf type="diffuse"/>
</bsdf>)",
         R"(<bsdf type="twosided">
    <bsdf type="diffuse">
        <rgb name="reflectance" value="0.7, 0.1, 0.1"/>
    </bsdf>
    <bsdf type="conductor">
        <string name="material" value="Cu"/>
    </bsdf>
</bsdf>)",
         R"(<bsdf type="twosided">
    <boolean name="allow_transmission" value="true"/>
    <bsdf type="thindielectric"/>
</bsdf>)"}});

}  // namespace
}  // namespace aureole
