// SPDX-License-Identifier: Apache-2.0
// Stacks against closed forms and published values, and what must be exact whatever the number of streams.
#include "aureole/optics/stack/plane_stack.h"

#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "aureole/optics/interface/fresnel_equations.h"
#include "optics/stack/stack_test_support.h"

namespace aureole::optics {
namespace {

using testing::hg_layer;
using testing::refractive_stack;
using testing::slide;
using testing::stack_of;

constexpr double kPi = std::numbers::pi;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Slab {
  double albedo, thickness, g, index;
  bool between_slides;  ///< of index 1.5
  double reflectance, transmittance, digits;
};

// Values of adding-doubling and discrete-ordinate programs; the first row is van de Hulst 1980.
TEST(PlaneStack, SlabTable) {
  for (const Slab& s :
       {Slab{.9, 2, .75, 1, false, .09739, .66096, 5e-6}, Slab{.5, 1, .9, 1, false, .004957, .590719, 6e-7},
        Slab{.5, 1, .9, 1.4, false, .038953, .545068, 6e-7},
        Slab{.5, 1, .9, 1.4, true, .056016, .530318, 6e-7}, Slab{1, 1, 0, 1, false, .341329, .658671, 6e-7},
        Slab{1, 8, .75, 1, false, .506415, .493585, 6e-7}, Slab{.9, kInfinity, 0, 1, false, .414947, 0, 6e-7},
        Slab{.99, kInfinity, 0, 1, false, .752721, 0, 6e-7},
        Slab{.9, kInfinity, 0, 1.5, false, .259919, 0, 6e-7},
        Slab{.99, 10, .8, 1.5, false, .346877, .327895, 6e-7}}) {
    std::vector<StackLayer> layers{hg_layer(s.thickness, s.albedo, s.g, s.index)};
    if (s.between_slides) layers = {slide(1.5), layers[0], slide(1.5)};
    const StackFluxes f = PlaneStack(stack_of(layers), {128}).fluxes(StackLight::beam(1));
    EXPECT_NEAR(f.reflectance, s.reflectance, s.digits);
    EXPECT_NEAR(f.transmittance, s.transmittance, s.digits);
    const StackFluxes half = PlaneStack(stack_of(layers), {64}).fluxes(StackLight::beam(1));
    EXPECT_NEAR(half.reflectance, f.reflectance, 1e-5);
    EXPECT_NEAR(half.transmittance, f.transmittance, 5e-5);
  }
}

TEST(PlaneStack, EnergyIsConserved) {
  double worst = 0;
  for (const int streams : {2, 4, 8, 34})
    for (int seed = 1; seed < 6; ++seed) {
      StackDescription d = refractive_stack(false, seed);
      if (seed == 4) d.layers[1].thickness = 1e4;
      const PlaneStack stack(d, {streams});
      const StackLight lights[] = {StackLight::beam(1), StackLight::beam(0.01), StackLight::beam(0.5, true),
                                   StackLight::diffuse(), StackLight::diffuse(true)};
      for (const StackFluxes& f : stack.fluxes(lights)) worst = std::max(worst, std::abs(f.absorptance()));
      d.substrate = 1;
      for (const StackFluxes& f : PlaneStack(d, {streams}).fluxes(std::span(lights).first(2)))
        worst = std::max({worst, std::abs(f.reflectance - 1), std::abs(f.transmittance)});
    }
  std::printf("largest error of energy at albedo 1: %.2g\n", worst);
  EXPECT_LT(worst, 1e-9);
}

TEST(PlaneStack, Reciprocity) {
  // Radiance I in one direction due to a beam from another: I/n^2 is the same with both exchanged.
  const StackDescription d = refractive_stack(true);
  for (const bool delta_m : {false, true}) {
    const PlaneStack stack(d, {16, delta_m});
    const double azimuths[] = {0.3, 2.5};
    const StackLight there[] = {StackLight::beam(0.35), StackLight::beam(0.8)};
    const double cosines[] = {0.35, 0.8, -0.6};
    const auto out = stack.radiance(there, cosines, azimuths);
    const StackLight back[] = {StackLight::beam(0.6, true)};
    const auto returned = stack.radiance(back, cosines, azimuths);
    for (int a = 0; a < 2; ++a) {
      EXPECT_NEAR(out[(0 * 3 + 1) * 2 + a], out[(1 * 3 + 0) * 2 + a], 1e-12);
      for (int i = 0; i < 2; ++i)
        EXPECT_NEAR(out[(i * 3 + 2) * 2 + a] / (1.2 * 1.2), returned[i * 2 + a], 1e-12)
            << "through the stack";
    }
  }
}

TEST(PlaneStack, SplitLayersAreOne) {
  StackDescription whole = refractive_stack(true), split = whole;
  split.layers.clear();
  for (const StackLayer& layer : whole.layers)
    for (const double share : {0.05, 0.6, 0.35}) {
      split.layers.push_back(layer);
      split.layers.back().thickness *= share;
    }
  const StackLight lights[] = {StackLight::beam(0.4), StackLight::diffuse(true)};
  const auto a = PlaneStack(whole, {12}).fluxes(lights), b = PlaneStack(split, {12}).fluxes(lights);
  const double cosines[] = {0.7, -0.2}, azimuths[] = {1};
  const auto p = PlaneStack(whole, {12}).radiance(lights, cosines, azimuths);
  const auto q = PlaneStack(split, {12}).radiance(lights, cosines, azimuths);
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR(a[i].reflectance, b[i].reflectance, 1e-12);
    EXPECT_NEAR(a[i].transmittance, b[i].transmittance, 1e-12);
    EXPECT_NEAR(a[i].unscattered_transmittance, b[i].unscattered_transmittance, 1e-12);
  }
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(p[i], q[i], 1e-12);
}

TEST(PlaneStack, BeerAndLambert) {
  for (const double mu : {1.0, 0.3}) {
    const StackFluxes f = PlaneStack(stack_of({hg_layer(2, 0, 0.5)})).fluxes(StackLight::beam(mu));
    EXPECT_NEAR(f.transmittance, std::exp(-2 / mu), 1e-15);
    EXPECT_NEAR(f.unscattered_transmittance, std::exp(-2 / mu), 1e-15);
    EXPECT_EQ(f.reflectance, 0);
  }
  // Thick layers that hardly scatter keep the digits of their transmittance.
  const StackFluxes thick = PlaneStack(stack_of({hg_layer(50, 1e-12, 0)})).fluxes(StackLight::beam(1));
  EXPECT_NEAR(thick.transmittance / std::exp(-50), 1, 1e-9);
}

TEST(PlaneStack, ThinLayersScatterOnce) {
  const double tau = 1e-6, g = 0.6, mu_in = 0.7;
  const PlaneStack stack(stack_of({hg_layer(tau, 0.8, g)}), {16});
  const StackLight lights[] = {StackLight::beam(mu_in)};
  const double cosines[] = {0.2, 0.9, -0.2, -0.9}, azimuths[] = {0, 1.3, kPi};
  const auto radiance = stack.radiance(lights, cosines, azimuths);
  for (int c = 0; c < 4; ++c)
    for (int a = 0; a < 3; ++a) {
      const double mu = cosines[c], across = std::sqrt((1 - mu * mu) * (1 - mu_in * mu_in));
      const double p = henyey_greenstein(-mu * mu_in + across * std::cos(azimuths[a]), g);
      EXPECT_NEAR(radiance[c * 3 + a] / (0.8 * p * tau / (mu_in * std::abs(mu))), 1, 2e-5);
    }
}

/// Chandrasekhar's H of isotropic scattering, by its integral equation.
struct HFunction {
  static constexpr int kNodes = 60;
  using Rule = boost::math::quadrature::gauss<double, kNodes>;
  double albedo;
  std::vector<double> mu, weight, h;
  explicit HFunction(double a) : albedo(a) {
    for (int i = 0; i < kNodes / 2; ++i)
      for (const double sign : {-1.0, 1.0})
        mu.push_back(0.5 + 0.5 * sign * Rule::abscissa()[i]), weight.push_back(0.5 * Rule::weights()[i]);
    h.assign(mu.size(), 1);
    for (int k = 0; k < 2000; ++k) {
      std::vector<double> next;
      for (const double m : mu) next.push_back(at(m));
      h = next;
    }
  }
  /// 1/H = sqrt(1 - a) + a/2 integral of mu' H(mu')/(mu + mu') (Chandrasekhar 1960, chapter V).
  double at(double m) const {
    double sum = 0;
    for (std::size_t i = 0; i < mu.size(); ++i) sum += weight[i] * mu[i] * h[i] / (m + mu[i]);
    return 1 / (std::sqrt(1 - albedo) + albedo / 2 * sum);
  }
};

TEST(PlaneStack, HalfSpaceOfChandrasekhar) {
  for (const double albedo : {0.3, 0.9, 0.999}) {
    const HFunction h(albedo);
    const PlaneStack stack(stack_of({hg_layer(kInfinity, albedo, 0)}), {48});
    const StackLight lights[] = {StackLight::beam(0.6)};
    const double cosines[] = {0.05, 0.5, 1}, azimuths[] = {0};
    const auto radiance = stack.radiance(lights, cosines, azimuths);
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(radiance[i], albedo / (4 * kPi) * h.at(0.6) * h.at(cosines[i]) / (0.6 + cosines[i]), 1e-6);
    EXPECT_NEAR(stack.fluxes(lights)[0].reflectance, 1 - h.at(0.6) * std::sqrt(1 - albedo), 1e-7);
  }
}

TEST(PlaneStack, ClearSlabs) {
  // 2 R/(1 + R) of two faces, at any angle; the same seen from below; light of a sky by quadrature.
  const PlaneStack glass(stack_of({slide(1.5)}), {32});
  for (const double mu : {1.0, 0.5, 0.05}) {
    const StackFluxes f = glass.fluxes(StackLight::beam(mu));
    EXPECT_NEAR(f.reflectance, thin_slab_reflectance(mu, 1, 1.5), 1e-12);
    EXPECT_NEAR(f.unscattered_reflectance, f.reflectance, 1e-12);
    EXPECT_NEAR(f.transmittance, 1 - f.reflectance, 1e-12);
  }
  const StackFluxes none = PlaneStack(stack_of({hg_layer(0, 0.5, 0)})).fluxes(StackLight::beam(0.5));
  EXPECT_EQ(none.transmittance, 1);
  EXPECT_EQ(none.unscattered_transmittance, 1);
  StackDescription water = stack_of({slide(1.33)});
  water.index_above = 1.33;
  const PlaneStack surface(water, {128});
  EXPECT_NEAR(surface.fluxes(StackLight::diffuse()).reflectance, fresnel_diffuse_reflectance(1 / 1.33), 1e-5);
  EXPECT_NEAR(surface.fluxes(StackLight::diffuse(true)).reflectance, fresnel_diffuse_reflectance(1.33), 1e-5);
  EXPECT_NEAR(surface.fluxes(StackLight::beam(0.5)).reflectance, 1, 1e-11) << "beyond the critical angle";
}

TEST(PlaneStack, Grazing) {
  const StackLight lights[] = {StackLight::beam(1e-6)};
  const double cosines[] = {1e-6, 1e-3, -1e-6}, azimuths[] = {0, 1};
  for (const double index : {1.0, 1.5})
    for (const double v :
         PlaneStack(stack_of({hg_layer(1, 0.9, 0.3, index)}), {16}).radiance(lights, cosines, azimuths))
      EXPECT_TRUE(std::isfinite(v) && v > -1e-9) << v;
}

/// The message of what is thrown.
template <class Call>
std::string refusal(const Call& call) {
  try {
    call();
  } catch (const std::domain_error& e) {
    return e.what();
  }
  return "nothing";
}

TEST(PlaneStack, BadInputIsRefused) {
  const auto refused = [](StackDescription d, const std::string& words, DiscreteOrdinates method = {}) {
    const std::string message = refusal([&] { PlaneStack(d, method); });
    EXPECT_NE(message.find(words), std::string::npos) << message;
  };
  const StackLayer good = hg_layer(1, 0.5, 0);
  StackLayer bad = good;
  refused(stack_of({}), "needs a layer");
  refused(stack_of({good}), "streams must be an even number", {7});
  bad.absorption = -1;
  refused(stack_of({good, bad}), "absorption of layer 1 must be finite and not negative, got -1");
  bad = good, bad.thickness = std::nan("");
  refused(stack_of({bad}), "thickness of layer 0");
  bad = good, bad.index = 0;
  refused(stack_of({bad}), "layer 0 must have an index");
  StackDescription d = stack_of({good});
  d.substrate = 1.5;
  refused(d, "reflectance of the substrate must be in [0, 1], got 1.5");
  EXPECT_NE(refusal([] { LegendrePhase::of_moments({0.5}); }).find("first moment"), std::string::npos);
  EXPECT_NE(refusal([] { LegendrePhase::henyey_greenstein(1); }).find("(-1, 1)"), std::string::npos);
  d.substrate = 0.5;
  const PlaneStack stack(d);
  EXPECT_NE(refusal([&] { stack.fluxes(StackLight::diffuse(true)); }).find("substrate"), std::string::npos);
  EXPECT_NE(refusal([&] { stack.fluxes(StackLight::beam(0)); }).find("cosine of a beam"), std::string::npos);
  const StackPosition outside[] = {{0, 2}};
  EXPECT_NE(refusal([&] { stack.fields(StackLight::diffuse(), outside); }).find("depth in layer 0"),
            std::string::npos);
}

}  // namespace
}  // namespace aureole::optics
