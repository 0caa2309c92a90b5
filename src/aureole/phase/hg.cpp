// SPDX-License-Identifier: Apache-2.0
// The Henyey-Greenstein phase function, with the mean cosine g as its parameter.
#include "aureole/phase/lobe/hg_lobe.h"
#include "aureole/phase/phase.h"
#include "aureole/plugin/registry.h"

namespace aureole {
namespace {

class Hg final : public PhaseFunction {
public:
  explicit Hg(const Properties& properties)
      : PhaseFunction(properties), lobe_(HenyeyGreenstein::from(properties, "g", 0.8)) {}

  PhaseEval eval_pdf(const Vec3& wi, const Vec3& wo, const PhaseContext&) const override {
    const float p = lobe_.eval(wi, wo);
    return {p, p};
  }
  std::optional<PhaseSample> sample(const Vec3& wi, float, Vec2 u2, const PhaseContext&) const override {
    const Vec3 wo = lobe_.sample(wi, u2);
    const float p = lobe_.eval(wi, wo);
    return PhaseSample{wo, p, p};
  }

private:
  HenyeyGreenstein lobe_;
};

AUREOLE_PLUGIN(
    Hg, "phase", "hg",
    PluginDoc{
        "The Henyey-Greenstein phase function: backward (g < 0), isotropic (g = 0) or forward scattering (g "
        "> 0), with g the mean cosine of the scattering angle.",
        "L. G. Henyey and J. L. Greenstein, Diffuse radiation in the galaxy, Astrophys. J. 93 (1941) 70",
        {{"g", "float", "", "0.8", "mean cosine of the scattering angle, in (-1, 1)"}},
        {R"(<phase type="hg">
    <float name="g" value="0.6"/>
</phase>)"}});

}  // namespace
}  // namespace aureole
