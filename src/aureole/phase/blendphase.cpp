// SPDX-License-Identifier: Apache-2.0
// A mixture of the particles of two phase functions. With projected areas a_0 and a_1 for the direction of
// the light,
//     a = (1 - w) a_0 + w a_1,   p = ((1 - w) a_0 p_0 + w a_1 p_1)/a.
// It equals Mitsuba's linear blend where both areas are 1, and is reciprocal where they are not.
#include <algorithm>
#include <string>

#include "aureole/math/warp.h"
#include "aureole/phase/phase.h"
#include "aureole/plugin/registry.h"
#include "aureole/volume/volume.h"

namespace aureole {
namespace {

class BlendPhase final : public PhaseFunction {
public:
  explicit BlendPhase(const Properties& properties)
      : PhaseFunction(properties),
        weight_(get_optional_volume(properties, "weight", SpectrumRole::reflectance)) {
    if (!weight_)
      throw properties.error("weight",
                             "the parameter \"weight\" is required, a number in [0, 1] or a volume");
    const auto nested = properties.get_children<PhaseFunction>("phase");
    if (nested.size() != 2)
      throw Error(properties.where(),
                  "\"blendphase\" needs two nested phase functions, got " + std::to_string(nested.size()));
    for (const std::size_t k : {0, 1}) nested_[k] = nested[k];
    is_isotropic_ = nested_[0]->is_isotropic_medium() && nested_[1]->is_isotropic_medium();
  }

  PhaseEval eval_pdf(const Vec3& wi, const Vec3& wo, const PhaseContext& ctx) const override {
    const float w = share_of_second(wi, ctx.p);
    PhaseEval sum;
    add(sum, 0, 1 - w, wi, wo, ctx);
    add(sum, 1, w, wi, wo, ctx);
    return sum;
  }

  std::optional<PhaseSample> sample(const Vec3& wi, float u1, Vec2 u2,
                                    const PhaseContext& ctx) const override {
    const float w = share_of_second(wi, ctx.p);
    const int drawn = u1 < w ? 1 : 0;
    const float share = drawn ? w : 1 - w;
    auto s = nested_[drawn]->sample(wi, drawn ? remap_below(u1, w) : remap_above(u1, w), u2, ctx);
    if (!s) return s;
    PhaseEval sum{s->value * share, s->pdf * share};
    add(sum, 1 - drawn, 1 - share, wi, s->wo, ctx);
    s->value = sum.value, s->pdf = sum.pdf;
    return s;
  }

  float projected_area(const Vec3& d, const Vec3& p) const override {
    if (is_isotropic_) return 1;
    const float w = weight_at(p);
    return (1 - w) * nested_[0]->projected_area(d, p) + w * nested_[1]->projected_area(d, p);
  }
  float largest_projected_area() const override {
    return std::max(nested_[0]->largest_projected_area(), nested_[1]->largest_projected_area());
  }
  bool is_isotropic_medium() const override { return is_isotropic_; }
  bool is_uniform() const override {
    return weight_->is_constant() && nested_[0]->is_uniform() && nested_[1]->is_uniform();
  }
  bool needs_choice() const override { return true; }

private:
  float weight_at(const Vec3& p) const { return std::clamp(weight_->eval_scalar(p), 0.f, 1.f); }
  /// Returns the fraction of the light from wi that particles of the second phase function scatter.
  float share_of_second(const Vec3& wi, const Vec3& p) const {
    const float w = weight_at(p);
    if (is_isotropic_) return w;
    const float first = (1 - w) * nested_[0]->projected_area(wi, p),
                second = w * nested_[1]->projected_area(wi, p);
    return second > 0 ? second / (first + second) : 0;
  }
  void add(PhaseEval& sum, int k, float share, const Vec3& wi, const Vec3& wo,
           const PhaseContext& ctx) const {
    if (!(share > 0)) return;
    const PhaseEval e = nested_[k]->eval_pdf(wi, wo, ctx);
    sum.value += e.value * share;
    sum.pdf += e.pdf * share;
  }

  VolumePtr weight_;
  PhaseFunctionPtr nested_[2];
  bool is_isotropic_ = true;
};

AUREOLE_PLUGIN(
    BlendPhase, "phase", "blendphase",
    PluginDoc{"A mixture of the particles of two phase functions, weighted by a number or a volume: haze in "
              "air, fibres in dust. The weight does not depend on the wavelength.",
              "",
              {{"weight", "volume", "", "required",
                "weight of the second phase function, in [0, 1]: 0 is the first alone, 1 the second"},
               {"phase", "phase", "", "required", "two nested phase functions"}},
              {R"(<phase type="blendphase">
    <float name="weight" value="0.3"/>
    <phase type="rayleigh"/>
    <phase type="hg">
        <float name="g" value="0.7"/>
    </phase>
</phase>)"}});

}  // namespace
}  // namespace aureole
