// SPDX-License-Identifier: Apache-2.0
// Scattering of unpolarised light by particles far smaller than the wavelength, such as the molecules of air:
//     p = 3/(16 pi (1 + 2 gamma)) (1 + 3 gamma + (1 - gamma) cos^2(theta)),   gamma = rho/(2 - rho),
// where rho is the depolarisation ratio of anisotropic molecules (S. Chandrasekhar, Radiative Transfer, 1960,
// section 18; A. Bucholtz, Rayleigh-scattering calculations for the terrestrial atmosphere, Appl. Opt. 34,
// 1995, equation 12).
#include <cmath>

#include "aureole/phase/lobe/deflection.h"
#include "aureole/phase/phase.h"
#include "aureole/plugin/registry.h"

namespace aureole {
namespace {

class Rayleigh final : public PhaseFunction {
public:
  explicit Rayleigh(const Properties& properties) : PhaseFunction(properties) {
    const double rho = properties.get_float("depolarization", 0, Range::unit()), gamma = rho / (2 - rho);
    const double factor = 3 / (16 * M_PI * (1 + 2 * gamma));
    flat_ = float(factor * (1 + 3 * gamma));
    curved_ = float(factor * (1 - gamma));
  }

  PhaseEval eval_pdf(const Vec3& wi, const Vec3& wo, const PhaseContext&) const override {
    const float p = eval(dot(wi, wo));
    return {p, p};
  }
  std::optional<PhaseSample> sample(const Vec3& wi, float, Vec2 u2, const PhaseContext&) const override {
    const float cosine = cosine_at(2 * u2.x - 1);
    const Vec3 wo = turn_from(-wi, 1 - cosine, u2.y);
    const float p = eval(dot(wi, wo));
    return PhaseSample{wo, p, p};
  }

private:
  float eval(float cosine) const { return flat_ + curved_ * cosine * cosine; }

  /// Returns the root of flat x + curved x^3/3 = v (flat + curved/3) for v in [-1, 1], by Newton's method.
  /// The slope stays within a factor of 2, so that five steps reach single precision.
  float cosine_at(float v) const {
    const float target = v * (flat_ + curved_ / 3);
    float x = v;
    for (int i = 0; i < 5; ++i)
      x -= (x * (flat_ + x * x * (curved_ / 3)) - target) / (flat_ + curved_ * x * x);
    return std::clamp(x, -1.f, 1.f);
  }

  float flat_, curved_;
};

AUREOLE_PLUGIN(
    Rayleigh, "phase", "rayleigh",
    PluginDoc{
        "Scattering by particles far smaller than the wavelength, such as the molecules of air. The "
        "dependence on the wavelength (lambda^-4) belongs to the coefficients of the medium.",
        "Lord Rayleigh, On the light from the sky, its polarization and colour, Phil. Mag. 41 (1871); A. "
        "Bucholtz, Appl. Opt. 34 (1995) 2765, equation 12",
        {{"depolarization", "float", "", "0",
          "depolarisation ratio of unpolarised light at 90 degrees, in [0, 1]: 0 for small spheres, 0.028 "
          "for air, at most 6/7 for molecules"}},
        {R"(<phase type="rayleigh"/>)", R"(<phase type="rayleigh">
    <float name="depolarization" value="0.028"/>
</phase>)"}});

}  // namespace
}  // namespace aureole
