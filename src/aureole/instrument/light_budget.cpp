// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/light_budget.h"

#include <algorithm>
#include <cmath>

namespace aureole {
namespace {

/// The sequence R3 (M. Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018).
struct Lattice {
  explicit Lattice(int i) : index(i + 1) {}
  float operator()(double step) const {
    return float(std::min(std::fmod(0.5 + index * step, 1.0), 0.99999994));
  }
  float choice() const { return (*this)(0.8191725133961645); }
  Vec2 direction() const { return {(*this)(0.6710436067037893), (*this)(0.5497004779019703)}; }
  double index;
};

}  // namespace

LightBudget measure_light_budget(const Bsdf& bsdf, const Vec3& wi, double nm, const SpectralGrid& grid,
                                 const LightBudgetSettings& settings) {
  const Wavelengths w = Wavelengths::at(grid, float(nm));
  SurfacePoint point;
  point.uv = settings.uv;
  const auto draw = [&](int i) {
    const Lattice x(i);
    const BsdfContext ctx{w, point, TransportMode::importance, std::uint32_t(i)};
    auto s = bsdf.sample(wi, x.choice(), x.direction(), ctx);
    if (s && !(s->pdf[0] > 0)) s.reset();
    return s;
  };
  const auto crosses = [&](const Vec3& wo) { return (wo.z > 0) != (wi.z > 0); };
  // Regular transmission leads where the delta lobe goes; without one, straight on.
  Vec3 regular = -wi;
  for (int i = 0; i < 1024; ++i)
    if (const auto s = draw(i); s && s->is_delta() && crosses(s->wo)) {
      regular = s->wo;
      break;
    }
  const double near = std::cos(settings.haze_angle_degrees * M_PI / 180);
  LightBudget b;
  b.nm = nm;
  for (int i = 0; i < settings.samples; ++i) {
    const auto s = draw(i);
    if (!s) continue;
    const double value = double(s->value[0]) / double(s->pdf[0]) / settings.samples;
    if (s->is_delta())
      (crosses(s->wo) ? b.direct_transmission : b.direct_reflection) += value;
    else if (!crosses(s->wo))
      b.diffuse_reflection += value;
    else
      (double(dot(s->wo, regular)) >= near ? b.near_transmission : b.far_transmission) += value;
  }
  return b;
}

}  // namespace aureole
