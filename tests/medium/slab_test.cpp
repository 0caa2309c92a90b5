// SPDX-License-Identifier: Apache-2.0
// Reflectance and transmittance of slabs, against values of adding-doubling and discrete-ordinate programs: a
// normal beam's total fluxes, unscattered light included. By reciprocity they are the radiance that leaves
// the slab along its normal where a uniform sky shines on one of its faces. The slab is a prism between
// perfect mirrors, which make it infinite.
//
// AUREOLE_THOROUGH=1 follows a million paths per number and prints what it finds.
#include <gtest/gtest.h>

#include "aureole/optics/stack/plane_stack.h"
#include "harness/rendered.h"
#include "medium/slab_scenes.h"

namespace aureole::testing {
namespace {

struct Slab {
  double albedo, thickness, g, index;
  bool between_slides;  ///< of index 1.5
  double reflectance, transmittance;
  double alpha = 0;  ///< roughness (GGX) of both faces
};

std::string interface(double outside, double inside, double alpha = 0) {
  if (outside == inside) return "<bsdf type=\"null\"/>";
  const std::string indices = parameter("ext_ior", outside) + parameter("int_ior", inside) + "</bsdf>";
  if (alpha == 0) return "<bsdf type=\"dielectric\">" + indices;
  return "<bsdf type=\"roughdielectric\"><string name=\"distribution\" value=\"ggx\"/><boolean "
         "name=\"energy_preserving\" value=\"true\"/>" +
         parameter("alpha", alpha) + indices;
}

/// The radiance that leaves the upper face along the normal; the sky is above, or below.
Picture measure(const Slab& slab, bool above) {
  const std::string medium = "<medium type=\"homogeneous\" name=\"interior\">" +
                             parameter("sigma_t", slab.thickness) + parameter("albedo", slab.albedo) +
                             "<phase type=\"hg\">" + parameter("g", slab.g) + "</phase></medium>";
  std::string scene =
      "<integrator type=\"path\"/><sensor type=\"orthographic\"><transform name=\"to_world\"><scale "
      "value=\"0.99\"/><lookat origin=\"0, 0, 2.5\" target=\"0, 0, 0\" up=\"0, 1, 0\"/></transform><sampler "
      "type=\"sobol\"><integer name=\"sample_count\" value=\"" +
      std::to_string(is_thorough() ? 1024 : 32) +
      "\"/></sampler><film type=\"hdrfilm\"><integer name=\"width\" value=\"8\"/><integer name=\"height\" "
      "value=\"8\"/><rfilter type=\"box\"/></film></sensor>";
  const double around = slab.between_slides ? 1.5 : 1;
  scene += level(1, true, interface(around, slab.index, slab.alpha) + medium);
  scene += level(0, false, interface(around, slab.index, slab.alpha) + medium);
  if (slab.between_slides)
    scene += level(1.5, true, interface(1, 1.5)) + level(-0.5, false, interface(1, 1.5));
  const std::string black = "<bsdf type=\"diffuse\">" + parameter("reflectance", 0) + "</bsdf>";
  scene += level(-2, true,
                 black + (above ? "" : "<emitter type=\"area\">" + parameter("radiance", 1) + "</emitter>"));
  if (above) scene += "<emitter type=\"constant\">" + parameter("radiance", 1) + "</emitter>";
  return render(scene + mirrors());
}

class SlabTest : public ::testing::TestWithParam<Slab> {};

TEST_P(SlabTest, FluxesAreThoseOfTheTable) {
  for (const bool above : {true, false}) {
    const double expected = above ? GetParam().reflectance : GetParam().transmittance;
    if (expected == 0) continue;
    const Picture p = measure(GetParam(), above);
    if (is_thorough())
      std::printf("%s %.6f +- %.6f, table %.6f (%+.2f standard errors)\n", above ? "R" : "T", p.all,
                  p.all_error, expected, (p.all - expected) / p.all_error);
    EXPECT_NEAR(p.all, expected, 4.5 * p.all_error + 1e-6) << (above ? "R" : "T");
    EXPECT_LT(p.all_error, 0.012);
  }
}

/// By adding and doubling (optics/stack), whose operators of rough interfaces keep energy as the BSDF does.
TEST(RoughSlab, IsThatOfDiscreteOrdinates) {
  for (const double alpha : {0.15, 0.4}) {
    const Slab slab{.9, 2, .5, 1.5, false, 0, 0, alpha};
    optics::StackDescription d;
    d.layers = {optics::StackLayer::of_optical_thickness(
        slab.thickness, slab.albedo, optics::LegendrePhase::henyey_greenstein(slab.g), slab.index)};
    d.layers[0].top = d.bottom = {optics::InterfaceKind::ggx, alpha};
    const optics::StackFluxes f = optics::PlaneStack(d, {64}).fluxes(optics::StackLight::beam(1));
    for (const bool above : {true, false}) {
      const double expected = above ? f.reflectance : f.transmittance;
      const Picture p = measure(slab, above);
      if (is_thorough())
        std::printf("alpha %.2f: %s %.6f +- %.6f, discrete ordinates %.6f\n", alpha, above ? "R" : "T", p.all,
                    p.all_error, expected);
      EXPECT_NEAR(p.all, expected, 3 * p.all_error + 0.003 * expected) << (above ? "R" : "T");
      EXPECT_LT(p.all_error, 0.012 * expected + 0.001);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Table, SlabTest,
    ::testing::Values(Slab{.9, 2, .75, 1, false, .09739, .66096}, Slab{.5, 1, .9, 1, false, .004957, .590719},
                      Slab{.5, 1, .9, 1.4, false, .038953, .545068},
                      Slab{.5, 1, .9, 1.4, true, .056016, .530318}, Slab{1, 1, 0, 1, false, .341329, .658671},
                      Slab{1, 8, .75, 1, false, .506415, .493585}, Slab{.9, 60, 0, 1, false, .414947, 0},
                      Slab{.99, 150, 0, 1, false, .752721, 0}, Slab{.9, 60, 0, 1.5, false, .259919, 0},
                      Slab{.99, 10, .8, 1.5, false, .346877, .327895}),
    [](const auto& info) { return "Row" + std::to_string(info.index + 1); });

}  // namespace
}  // namespace aureole::testing
