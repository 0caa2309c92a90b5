// SPDX-License-Identifier: Apache-2.0
// Kernels over all directions against radiances of single beams, and substrates with lobes against what they
// are made of: a mirror against the slab of twice the thickness, a lobe without direction against Lambert's.
#include "aureole/optics/stack/stack_kernels.h"

#include <gtest/gtest.h>

#include <cmath>

#include "aureole/optics/interface/fresnel_equations.h"

namespace aureole::optics {
namespace {

StackDescription coat_on_slab(InterfaceKind kind) {
  StackDescription d;
  d.layers = {StackLayer::of_optical_thickness(0.5, 0.9, LegendrePhase::henyey_greenstein(0.8), 1.4),
              StackLayer::of_optical_thickness(2, 0.99, LegendrePhase::henyey_greenstein(-0.3), 1.6)};
  d.layers[0].top = {kind, 0.3};
  d.index_below = 1.2;
  return d;
}

TEST(StackKernels, LightThatReachesASubstrate) {
  StackDescription d;
  d.layers = {StackLayer::of_optical_thickness(0.7, 1, LegendrePhase::henyey_greenstein(0.6), 1.5)};
  d.substrate = 0;
  const std::vector<double> azimuths{0, 1};
  const StackKernels k = stack_kernels(std::span(&d, 1), {32}, azimuths).front();
  ASSERT_EQ(k.above.reached.size(), k.above.cosines.size());
  for (const std::size_t i : {std::size_t(1), k.above.cosines.size() / 2, k.above.cosines.size() - 1})
    EXPECT_NEAR(k.above.reached[i],
                PlaneStack(d, {32}).fluxes(StackLight::beam(k.above.cosines[i])).transmittance, 1e-6);
  // Nothing is absorbed between a substrate and the sky, and what comes back is that of light from below.
  EXPECT_NEAR(k.returned + k.left, 1, 1e-9);
  StackDescription open = d;
  open.substrate.reset(), open.index_below = 1.5;
  EXPECT_NEAR(k.returned, PlaneStack(open, {32}).fluxes(StackLight::diffuse(true)).reflectance, 1e-9);
}

TEST(StackKernels, NormalDirectionsStayNormal) {
  // Cosines of refracted normal directions must not be 1 + 2e-16: single scattering has the sine.
  const std::vector<double> azimuths{0, 2};
  std::vector<StackDescription> stacks(60);
  for (std::size_t i = 0; i < stacks.size(); ++i) {
    stacks[i].layers = {StackLayer::of_optical_thickness(1, 0.9, LegendrePhase::henyey_greenstein(0.7),
                                                         1.7 + 0.0037 * double(i))};
    stacks[i].substrate = 0;
  }
  for (const StackKernels& k : stack_kernels(stacks, {8}, azimuths))
    for (const double v : k.reflected_above) ASSERT_TRUE(std::isfinite(v));
}

TEST(StackKernels, IndicesThatMayDiffer) {
  StackDescription a, b;
  a.layers = {StackLayer::of_optical_thickness(1, 1, LegendrePhase::isotropic(), 1.5)};
  b.layers = {StackLayer::of_optical_thickness(1, 1, LegendrePhase::isotropic(), 1.6)};
  EXPECT_TRUE(have_same_directions(a, b));
  b.layers[0].index = 1;  // as outside: one range of directions, not two
  EXPECT_FALSE(have_same_directions(a, b));
  a.index_above = b.index_above = 2, a.index_below = b.index_below = 2, b.layers[0].index = 1.6;
  EXPECT_FALSE(have_same_directions(a, b));
  b.layers[0].index = 1.5;
  EXPECT_TRUE(have_same_directions(a, b));
}

class Kernels : public ::testing::TestWithParam<InterfaceKind> {};

TEST_P(Kernels, AreTheRadianceOfEachBeam) {
  const StackDescription d = coat_on_slab(GetParam());
  const bool is_smooth = GetParam() == InterfaceKind::smooth;
  const DiscreteOrdinates method{24};
  const std::vector<double> azimuths{0, 0.4, 2};
  const StackKernels k = stack_kernels(std::span(&d, 1), method, azimuths).front();
  const std::size_t above = k.above.cosines.size(), below = k.below.cosines.size();
  ASSERT_EQ(k.transmitted.size(), above * below * azimuths.size());
  EXPECT_EQ(kernel_pairs(d, method.streams) * azimuths.size(),
            k.reflected_above.size() + k.transmitted.size() + k.reflected_below.size());
  double most = 0;
  for (const double v : k.reflected_above) most = std::max(most, v);
  const PlaneStack stack(d, method);
  for (const std::size_t i : {is_smooth ? std::size_t(0) : above / 2, above / 2, above - 1})
    for (const std::size_t o : {is_smooth ? std::size_t(1) : above / 2, above / 2, above - 1}) {
      const StackLight light = StackLight::beam(k.above.cosines[i]);
      const double up = k.above.cosines[o], down = -k.below.cosines[std::min(o, below - 1)];
      const auto r = stack.radiance(std::span(&light, 1), std::span(&up, 1), azimuths),
                 t = stack.radiance(std::span(&light, 1), std::span(&down, 1), azimuths);
      for (std::size_t a = 0; a < azimuths.size(); ++a) {
        // Rough lobes are averaged over rings, of which the extra directions of `radiance` have none.
        if (!is_smooth) continue;
        const double tolerance = 1e-6 * most;
        EXPECT_NEAR(k.reflected_above[(i * above + o) * 3 + a], r[a], tolerance) << i << " " << o;
        EXPECT_NEAR(k.transmitted[(i * below + std::min(o, below - 1)) * 3 + a] * 1.44, t[a], tolerance)
            << i << " " << o;
      }
    }
  // Shares are the fluxes of the beam.
  const StackFluxes f = stack.fluxes(StackLight::beam(k.above.cosines[above / 2]));
  EXPECT_NEAR(k.above.mirrored[above / 2], f.unscattered_reflectance, 1e-9);
  EXPECT_NEAR(k.above.passed[above / 2], f.unscattered_transmittance, 1e-9);
  EXPECT_NEAR(k.above.mirrored[above / 2] + k.above.passed[above / 2] + k.above.scattered[above / 2],
              f.reflectance + f.transmittance, is_smooth ? 1e-9 : 3e-3);
  // Reciprocity, here of light from below with itself.
  for (std::size_t i = 0; i < below; ++i)
    for (std::size_t o = 0; o < i; ++o)
      EXPECT_NEAR(k.reflected_below[(i * below + o) * 3 + 1], k.reflected_below[(o * below + i) * 3 + 1],
                  1e-7 * most);
}
INSTANTIATE_TEST_SUITE_P(Of, Kernels, ::testing::Values(InterfaceKind::smooth, InterfaceKind::ggx),
                         [](const auto& i) { return i.param == InterfaceKind::smooth ? "Smooth" : "Rough"; });

TEST(StackSubstrate, MirrorUnfoldsTheLayer) {
  // A layer on a perfect mirror is half of one twice as thick: what passes the mirror's plane comes back.
  StackDescription half, whole;
  half.layers = {StackLayer::of_optical_thickness(0.7, 0.8, LegendrePhase::henyey_greenstein(0.4), 1.5)};
  whole.layers = {StackLayer::of_optical_thickness(1.4, 0.8, LegendrePhase::henyey_greenstein(0.4), 1.5)};
  half.substrate = 0, half.mirror = [](double) { return 1.0; };
  for (const double mu : {0.2, 1.0}) {
    const StackFluxes one = PlaneStack(half).fluxes(StackLight::beam(mu)),
                      two = PlaneStack(whole).fluxes(StackLight::beam(mu));
    EXPECT_NEAR(one.reflectance, two.reflectance + two.transmittance, 1e-9);
    EXPECT_NEAR(one.unscattered_reflectance, two.unscattered_reflectance + two.unscattered_transmittance,
                1e-9);
    EXPECT_NEAR(one.transmittance, 0, 1e-9);
  }
}

TEST(StackSubstrate, BrdfWithoutDirectionIsLambertian) {
  StackDescription a, b;
  a.layers =
      b.layers = {StackLayer::of_optical_thickness(0.7, 0.8, LegendrePhase::henyey_greenstein(0.4), 1.5)};
  a.substrate = 0.6;
  b.substrate = 0, b.brdf = [](double, double, double) { return 0.6 / M_PI; };
  for (const double mu : {0.2, 1.0})
    EXPECT_NEAR(PlaneStack(a).fluxes(StackLight::beam(mu)).reflectance,
                PlaneStack(b).fluxes(StackLight::beam(mu)).reflectance, 1e-9);
}

TEST(StackSubstrate, NeedsToBeThere) {
  StackDescription d;
  d.layers = {StackLayer::of_optical_thickness(1, 1)};
  d.mirror = [](double) { return 1.0; };
  EXPECT_THROW(PlaneStack{d}, std::domain_error);
}

}  // namespace
}  // namespace aureole::optics
