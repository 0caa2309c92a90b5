// SPDX-License-Identifier: Apache-2.0
// A forward and a backward Henyey-Greenstein lobe. Most particles have a forward peak and some
// backscattering, which one lobe alone cannot represent.
#include "aureole/phase/lobe/hg_lobe.h"
#include "aureole/phase/phase.h"
#include "aureole/plugin/registry.h"

namespace aureole {
namespace {

class DoubleHg final : public PhaseFunction {
public:
  explicit DoubleHg(const Properties& p)
      : PhaseFunction(p),
        first_(HenyeyGreenstein::from(p, "g_forward", 0.8)),
        second_(HenyeyGreenstein::from(p, "g_backward", -0.3)),
        weight_(float(p.get_float("weight", 0.9, Range::unit()))) {}

  PhaseEval eval_pdf(const Vec3& wi, const Vec3& wo, const PhaseContext&) const override {
    const float p = eval(wi, wo);
    return {p, p};
  }
  std::optional<PhaseSample> sample(const Vec3& wi, float u1, Vec2 u2, const PhaseContext&) const override {
    const Vec3 wo = (u1 < weight_ ? first_ : second_).sample(wi, u2);
    const float p = eval(wi, wo);
    return PhaseSample{wo, p, p};
  }
  bool needs_choice() const override { return true; }

private:
  float eval(const Vec3& wi, const Vec3& wo) const {
    return weight_ * first_.eval(wi, wo) + (1 - weight_) * second_.eval(wi, wo);
  }

  HenyeyGreenstein first_, second_;
  float weight_;
};

AUREOLE_PLUGIN(DoubleHg, "phase", "double_hg",
               PluginDoc{
                   "Two Henyey-Greenstein lobes, a forward and a backward one. The mean cosine is weight "
                   "g_forward + (1 - weight) g_backward.",
                   "G. W. Kattawar, A three-parameter analytic phase function for multiple scattering "
                   "calculations, J. Quant. Spectrosc. Radiat. Transfer 15 (1975) 839",
                   {{"g_forward", "float", "", "0.8", "mean cosine of the forward lobe, in (-1, 1)"},
                    {"g_backward", "float", "", "-0.3", "mean cosine of the backward lobe, in (-1, 1)"},
                    {"weight", "float", "", "0.9", "weight of the forward lobe, in [0, 1]"}},
                   {R"(<phase type="double_hg">
    <float name="g_forward" value="0.9"/> <float name="g_backward" value="-0.4"/>
    <float name="weight" value="0.8"/>
</phase>)"}});

}  // namespace
}  // namespace aureole
