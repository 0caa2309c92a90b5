// SPDX-License-Identifier: Apache-2.0
// Direct light, diffuse light and haze of layers whose shares are known: by the weights of the model and by
// quadrature of its intensity.
#include "aureole/instrument/light_budget.h"

#include <gtest/gtest.h>

#include <cmath>

#include "aureole/optics/interface/fresnel_equations.h"
#include "aureole/optics/layer/scatterer_layer.h"
#include "harness/properties_builder.h"

namespace aureole {
namespace {

LightBudget measure(const std::string& xml, double degrees = 0, double nm = 550) {
  const double t = degrees * M_PI / 180;
  const auto context = testing::make_context();
  return measure_light_budget(*testing::build<Bsdf>(xml, context),
                              {float(std::sin(t)), 0, float(std::cos(t))}, nm, context->grid, {});
}

TEST(LightBudget, DiffuseAndGlass) {
  const LightBudget d = measure(R"(<bsdf type="diffuse"><float name="reflectance" value="0.4"/></bsdf>)");
  EXPECT_NEAR(d.diffuse_reflection, 0.4, 1e-4);
  EXPECT_NEAR(d.lost(), 0.6, 1e-4);
  for (double degrees : {0., 50., 130., 170.}) {  // beyond 90 from inside
    const LightBudget g = measure(
        R"(<bsdf type="dielectric"><float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/></bsdf>)",
        degrees);
    const bool inside = degrees > 90;
    const double r = optics::fresnel_reflectance(std::abs(std::cos(degrees * M_PI / 180)), inside ? 1.5 : 1,
                                                 inside ? 1 : 1.5);
    EXPECT_NEAR(g.direct_reflection, r, 3e-4) << degrees;
    EXPECT_NEAR(g.direct_transmission, 1 - r, 3e-4) << degrees;
    EXPECT_NEAR(g.lost(), 0, 1e-6);
  }
}

TEST(LightBudget, HazeOfALayerIsThatOfItsIntensity) {
  for (const auto& [scatterer, fa] : {std::pair{"apertures", 0.5}, std::pair{"discs", 0.3}}) {
    const double radius = 5e-6, nm = 550;
    const LightBudget b = measure(
        std::string(R"(<bsdf type="correlated_scatterers"><string name="scatterer" value=")") + scatterer +
            R"("/><string name="radius" value="5um"/><float name="ext_ior" value="1"/><float name="area_fraction" value=")" +
            std::to_string(fa) + "\"/></bsdf>",
        0, nm);
    const bool discs = scatterer == std::string("discs");
    EXPECT_NEAR(b.direct_transmission, discs ? (1 - fa) * (1 - fa) : fa * fa, 3e-4);
    EXPECT_EQ(b.reflection(), 0);
    // (1/4 pi^2) times the integral of J over real waves, within and beyond 2.5 degrees.
    const optics::ScattererLayer layer(radius, radius, fa);
    const double k = 2 * M_PI / (nm * 1e-9), limit = k * std::sin(2.5 * M_PI / 180);
    double near = 0, far = 0;
    const int steps = 40000;
    for (int i = 0; i < steps; ++i) {
      const double q = k * (i + 0.5) / steps;
      (q < limit ? near : far) += layer.intensity(q) * layer.normalisation() * q * (k / steps) / (2 * M_PI);
    }
    EXPECT_NEAR(b.near_transmission, near, 5e-4) << scatterer;
    EXPECT_NEAR(b.far_transmission, far, 5e-4) << scatterer;
    EXPECT_NEAR(b.lost(), 1 - b.direct_transmission - near - far, 1e-3);
  }
}

}  // namespace
}  // namespace aureole
