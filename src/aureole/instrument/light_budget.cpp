// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/light_budget.h"

#include <cmath>

#include "aureole/plugin/registry.h"
#include "aureole/sampler/sampler.h"

namespace aureole {
namespace {

/// Makes the Sobol sampler that rendering uses.
std::shared_ptr<const Sampler> sobol(const Bsdf& bsdf) {
  const PluginInfo* info = Registry::instance().find("sampler", "sobol");
  return std::dynamic_pointer_cast<const Sampler>(
      info->create(Properties(info->name, "", {}, bsdf.properties().shared_context(), info)));
}

}  // namespace

LightBudget measure_light_budget(const Bsdf& bsdf, const Vec3& wi, double nm, const SpectralGrid& grid,
                                 const LightBudgetSettings& settings) {
  const Wavelengths w = Wavelengths::at(grid, float(nm));
  SurfacePoint point;
  point.uv = settings.uv;
  const auto sampler = sobol(bsdf);
  const auto draw = [&](int i) {
    float x[Sampler::kBlock];
    sampler->block(0, std::uint32_t(i), 0, x);
    const BsdfContext ctx{w, point, TransportMode::importance, std::uint32_t(i)};
    auto s = bsdf.sample(wi, x[0], {x[1], x[2]}, ctx);
    if (s && !(s->pdf[0] > 0)) s.reset();
    return s;
  };
  const auto crosses = [&](const Vec3& wo) { return (wo.z > 0) != (wi.z > 0); };
  // The regular direction of transmission is the direction of the delta lobe; without a delta lobe it is
  // undeviated.
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
