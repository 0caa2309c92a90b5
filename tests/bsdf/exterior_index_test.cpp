// SPDX-License-Identifier: Apache-2.0
// An interface in another medium than its scene file says is the interface that a scene file would say.
#include <gtest/gtest.h>

#include "aureole/bsdf/bsdf.h"
#include "aureole/math/significance.h"
#include "aureole/math/warp.h"
#include "harness/properties_builder.h"

namespace aureole {
namespace {

using testing::build;

class ExteriorIndex : public ::testing::TestWithParam<const char*> {};

TEST_P(ExteriorIndex, OfTheContextIsThatOfTheFile) {
  const auto bsdf = [](const std::string& interior, double exterior) {
    const std::string type = GetParam(),
                      alpha = type == "roughdielectric" ? R"(<float name="alpha" value="0.3"/>)" : "";
    return build<Bsdf>("<bsdf type=\"" + type + "\">" + interior + alpha +
                       "<float name=\"ext_ior\" value=\"" + std::to_string(exterior) + "\"/></bsdf>");
  };
  const SpectralGrid grid = SpectralGrid::over(360, 830);
  const Wavelengths w = Wavelengths::at(grid, make_spectrum([](int i) { return 420.f + 40 * float(i); }));
  const SurfacePoint point;
  const Spectrum water(1.33f);
  for (const std::string interior :
       {R"(<float name="int_ior" value="1.5"/>)", R"(<string name="int_ior" value="bk7"/>)"}) {
    const auto in_air = bsdf(interior, 1), in_water = bsdf(interior, 1.33);
    SeededRandom random(1);
    int samples = 0;
    for (int k = 0; k < 2000; ++k) {
      const TransportMode mode = k % 2 ? TransportMode::radiance : TransportMode::importance;
      const BsdfContext in_file{w, point, mode}, in_context{w, point, mode, 0, &water};
      const Vec3 wi = square_to_uniform_sphere(random.next2()), wo = square_to_uniform_sphere(random.next2());
      const float u1 = random.next();
      const Vec2 u2 = random.next2();
      const auto a = in_water->sample(wi, u1, u2, in_file), b = in_air->sample(wi, u1, u2, in_context);
      const BsdfEval e = in_water->eval_pdf(wi, wo, in_file), f = in_air->eval_pdf(wi, wo, in_context);
      ASSERT_EQ(a.has_value(), b.has_value());
      for (int i = 0; i < kWavelengths; ++i) {
        EXPECT_NEAR(e.value[i], f.value[i], 1e-4f * (1e-3f + e.value[i]));
        EXPECT_NEAR(e.pdf[i], f.pdf[i], 1e-4f * (1e-3f + e.pdf[i]));
      }
      if (!a) continue;
      ++samples;
      EXPECT_LT(length(a->wo - b->wo), 1e-4f);
      EXPECT_NEAR(a->eta, b->eta, 1e-5f);
      for (int i = 0; i < kWavelengths; ++i) {
        EXPECT_NEAR(a->value[i], b->value[i], 1e-3f * (1e-3f + a->value[i])) << k;
        EXPECT_NEAR(a->pdf[i], b->pdf[i], 1e-3f * (1e-3f + a->pdf[i])) << k;
      }
    }
    EXPECT_GT(samples, 1000);
  }
}

INSTANTIATE_TEST_SUITE_P(Interfaces, ExteriorIndex,
                         ::testing::Values("dielectric", "thindielectric", "roughdielectric"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace aureole
