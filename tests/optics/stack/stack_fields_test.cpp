// SPDX-License-Identifier: Apache-2.0
// Light within stacks, and by rings of directions: two and four fluxes, balances, continuity.
#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <numbers>
#include <vector>

#include "optics/stack/stack_test_support.h"

namespace aureole::optics {
namespace {

using testing::hg_layer;
using testing::refractive_stack;
using testing::stack_of;

constexpr double kPi = std::numbers::pi;

// Kubelka & Munk 1931 with the coefficients of two streams, K = 2 sigma_a and S = sigma_s (1 - 3/4 g), in the
// form of sinh and cosh.
TEST(StackFields, TwoStreamsAreKubelkaAndMunk) {
  for (const double albedo : {0.3, 0.9, 0.999})
    for (const double g : {0.0, 0.6})
      for (const double tau : {0.1, 3.0})
        for (const double below : {0.0, 0.5}) {
          StackDescription d = stack_of({hg_layer(tau, albedo, g)});
          d.substrate = below;
          const double k = 2 * (1 - albedo), s = albedo * (1 - 0.75 * g);
          const double a = 1 + k / s, b = std::sqrt(a * a - 1), z = b * s * tau;
          const double coth = b / std::tanh(z), r = (1 - below * (a - coth)) / (a - below + coth);
          const PlaneStack stack(d, {2, false});
          EXPECT_NEAR(stack.fluxes(StackLight::diffuse()).reflectance, r, 1e-12);
          const StackPosition at[] = {{0, 0}, {0, 0.4 * tau}, {0, tau}};
          for (const StackField& f : stack.fields(StackLight::diffuse(), at)) {
            EXPECT_NEAR(f.absorption_down, k, 1e-9);
            EXPECT_NEAR(f.backscatter_down, s, 1e-9);
            if (f.flux_up > 0) {
              EXPECT_NEAR(f.absorption_up, k, 1e-9);
              EXPECT_NEAR(f.backscatter_up, s, 1e-9);
            }
          }
        }
}

TEST(StackFields, FourStreamsAreBetterThanTwo) {
  const StackDescription d = stack_of({hg_layer(3, 0.9, 0.5)});
  const double exact = PlaneStack(d, {64}).fluxes(StackLight::diffuse()).reflectance;
  const double two = PlaneStack(d, {2}).fluxes(StackLight::diffuse()).reflectance,
               four = PlaneStack(d, {4}).fluxes(StackLight::diffuse()).reflectance;
  std::printf("two-flux %.5f, four-flux %.5f, 64 streams %.5f\n", two, four, exact);
  EXPECT_LT(std::abs(four - exact), 0.1 * std::abs(two - exact));
}

TEST(StackFields, FluxesInsideAreContinuousAndBalance) {
  const StackDescription d = refractive_stack(true);
  const PlaneStack stack(d, {24});
  const StackLight light = StackLight::beam(0.7);
  const StackFluxes f = stack.fluxes(light);
  std::vector<StackPosition> at;
  double absorbed = 0;
  using Rule = boost::math::quadrature::gauss<double, 15>;
  std::vector<double> weights;
  for (int i = 0; i < 3; ++i) {
    const double thickness = d.layers[i].thickness;
    for (std::size_t k = 0; k < Rule::abscissa().size(); ++k)
      for (const double sign : {-1.0, 1.0}) {
        if (Rule::abscissa()[k] == 0 && sign > 0) continue;
        at.push_back({i, 0.5 * thickness * (1 + sign * Rule::abscissa()[k])});
        weights.push_back(0.5 * thickness * Rule::weights()[k] * d.layers[i].absorption);
      }
  }
  const auto fields = stack.fields(light, at);
  for (std::size_t i = 0; i < at.size(); ++i)
    absorbed += weights[i] * (fields[i].fluence_down + fields[i].fluence_up);
  EXPECT_NEAR(absorbed, f.absorptance(), 1e-8) << "absorption, by fluence, of all depths";

  // The net flux goes through interfaces as it is, and is what is left of the incident light.
  const StackPosition ends[] = {{0, 0}, {0, d.layers[0].thickness}, {1, 0}, {2, d.layers[2].thickness}};
  const auto edge = stack.fields(light, ends);
  const auto net = [&](int i) { return edge[i].flux_down - edge[i].flux_up; };
  EXPECT_NEAR(net(0), 1 - f.reflectance, 1e-12);
  EXPECT_NEAR(net(1), net(2), 1e-12);
  EXPECT_NEAR(net(3), f.transmittance, 1e-12);
}

TEST(StackFields, CoefficientsByDepthMakeTheTwoFluxEquations) {
  const StackDescription d = stack_of({hg_layer(4, 0.9, 0.7)});
  const PlaneStack stack(d, {32});
  const double step = 1e-4;
  const StackPosition at[] = {{0, 1 - step}, {0, 1}, {0, 1 + step}};
  const auto f = stack.fields(StackLight::diffuse(), at);
  const double down = (f[2].flux_down - f[0].flux_down) / (2 * step),
               up = (f[2].flux_up - f[0].flux_up) / (2 * step);
  EXPECT_NEAR(
      down,
      -(f[1].absorption_down + f[1].backscatter_down) * f[1].flux_down + f[1].backscatter_up * f[1].flux_up,
      1e-7);
  EXPECT_NEAR(
      -up,
      -(f[1].absorption_up + f[1].backscatter_up) * f[1].flux_up + f[1].backscatter_down * f[1].flux_down,
      1e-7);
}

TEST(StackFields, RadianceAddsUpToFluxes) {
  const PlaneStack stack(stack_of({hg_layer(2, 0.9, 0.5, 1.4), hg_layer(1, 0.7, 0.3, 1.4)}), {48, false});
  using Rule = boost::math::quadrature::gauss<double, 30>;
  std::vector<double> cosines, weights;
  for (std::size_t k = 0; k < Rule::abscissa().size(); ++k)
    for (const double sign : {-1.0, 1.0}) {
      const double mu = 0.5 * (1 + sign * Rule::abscissa()[k]);
      cosines.push_back(mu), weights.push_back(kPi * Rule::weights()[k] * mu);
    }
  const StackLight lights[] = {StackLight::beam(0.45), StackLight::diffuse()};
  std::vector<double> azimuths;
  for (int i = 0; i < 32; ++i) azimuths.push_back(2 * kPi * i / 32);
  const auto radiance = stack.radiance(lights, cosines, azimuths);
  const auto fluxes = stack.fluxes(lights);
  for (int l = 0; l < 2; ++l) {
    double sum = 0;
    for (std::size_t c = 0; c < cosines.size(); ++c)
      for (int a = 0; a < 32; ++a) sum += weights[c] / 32 * radiance[(l * cosines.size() + c) * 32 + a];
    EXPECT_NEAR(sum, fluxes[l].reflectance - (l == 0 ? fluxes[l].unscattered_reflectance : 0), 1e-5);
  }
}

TEST(StackFields, FiniteChannels) {
  const StackDescription d = stack_of({hg_layer(1.5, 1, 0.6, 1.4)});
  const PlaneStack stack(d, {32});
  const double cosines[] = {0.9, 0.6, 0.3};
  const StackChannels c = stack.channels(cosines);
  ASSERT_EQ(c.reflected.size(), 16u);
  EXPECT_NEAR(c.projected_solid_angle[0], kPi * (1 - 0.81), 1e-12);
  double all = 0;
  for (int j = 0; j < 4; ++j) {
    double sum = 0;
    for (int i = 0; i < 4; ++i) {
      sum += c.reflected[i * 4 + j] + c.transmitted[i * 4 + j];
      all += c.reflected[i * 4 + j] * c.projected_solid_angle[j] / kPi;
      EXPECT_NEAR(c.reflected[i * 4 + j] * c.projected_solid_angle[j],
                  c.reflected[j * 4 + i] * c.projected_solid_angle[i], 1e-12);
    }
    EXPECT_NEAR(sum, 1, 1e-9);
  }
  EXPECT_NEAR(all, PlaneStack(d, {64}).fluxes(StackLight::diffuse()).reflectance, 1e-4) << "a Lambertian sky";
}

}  // namespace
}  // namespace aureole::optics
