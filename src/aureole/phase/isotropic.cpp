// SPDX-License-Identifier: Apache-2.0
// Isotropic scattering.
#include "aureole/math/warp.h"
#include "aureole/phase/phase.h"
#include "aureole/plugin/registry.h"

namespace aureole {
namespace {

class Isotropic final : public PhaseFunction {
public:
  using PhaseFunction::PhaseFunction;

  PhaseEval eval_pdf(const Vec3&, const Vec3&, const PhaseContext&) const override {
    return {kUniform, kUniform};
  }
  std::optional<PhaseSample> sample(const Vec3&, float, Vec2 u2, const PhaseContext&) const override {
    return PhaseSample{square_to_uniform_sphere(u2), kUniform, kUniform};
  }

private:
  static constexpr float kUniform = 1 / (4 * kPi);
};

AUREOLE_PLUGIN(Isotropic, "phase", "isotropic",
               PluginDoc{"Isotropic scattering: p = 1/(4 pi). The default of a medium.",
                         "",
                         {},
                         {R"(<phase type="isotropic"/>)"}});

}  // namespace
}  // namespace aureole
