// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "aureole/pigment/kubelka_munk_inverse.h"
#include "aureole/pigment/kubelka_munk_layer.h"
#include "aureole/pigment/transport_coefficients.h"

namespace aureole::pigment {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The two differential equations, followed from the substrate upwards by Runge and Kutta's fourth-order
/// method: fluxes relative to the downward one at the substrate.
Fluxes integrated(Coefficients c, double height, double substrate) {
  constexpr int kSteps = 4000;
  const double h = height / kSteps;
  std::array<double, 2> y{1, substrate};
  const auto slope = [&](const std::array<double, 2>& v) {
    return std::array<double, 2>{(c.k + c.s) * v[0] - c.s * v[1], -(c.k + c.s) * v[1] + c.s * v[0]};
  };
  const auto moved = [&](const std::array<double, 2>& d, double step) {
    return std::array<double, 2>{y[0] + step * d[0], y[1] + step * d[1]};
  };
  for (int i = 0; i < kSteps; ++i) {
    const auto k1 = slope(y), k2 = slope(moved(k1, h / 2)), k3 = slope(moved(k2, h / 2)),
               k4 = slope(moved(k3, h));
    for (std::size_t j = 0; j < 2; ++j) y[j] += h / 6 * (k1[j] + 2 * k2[j] + 2 * k3[j] + k4[j]);
  }
  return {y[0], y[1]};
}

TEST(KubelkaMunk, SolvesItsDifferentialEquations) {
  for (const Coefficients c : {Coefficients{0.3, 2}, {2, 0.3}, {0, 1}, {1, 0}, {1e-9, 1.5}, {0.7, 1e-9}})
    for (const double thickness : {0.01, 0.5, 3.0}) {
      const Fluxes black = integrated(c, thickness, 0);
      const LayerTransfer t = layer(c, thickness);
      EXPECT_NEAR(t.reflectance, black.up / black.down, 1e-12) << c.k << " " << c.s << " " << thickness;
      EXPECT_NEAR(t.transmittance, 1 / black.down, 1e-12);
      for (const double substrate : {0.2, 0.9}) {
        const Fluxes top = integrated(c, thickness, substrate);
        EXPECT_NEAR(reflectance_over(t, substrate), top.up / top.down, 1e-12);
        const Fluxes inside = integrated(c, 0.4 * thickness, substrate);
        const Fluxes f = fluxes_within(c, thickness, substrate, 0.6 * thickness);
        EXPECT_NEAR(f.down, inside.down / top.down, 1e-12);
        EXPECT_NEAR(f.up, inside.up / top.down, 1e-12);
        EXPECT_NEAR(f.reflectance(), inside.up / inside.down, 1e-12);
      }
    }
}

TEST(KubelkaMunk, ClosedLimits) {
  // Beer and Lambert; S may be as small as it likes.
  for (const double s : {0.0, 1e-300, 1e-18}) {
    EXPECT_NEAR(layer({1.7, s}, 2).transmittance / std::exp(-3.4), 1, 1e-14);
    EXPECT_NEAR(layer({1.7, s}, 2).reflectance, 0, 1e-17);
  }
  // No absorption.
  for (const double k : {0.0, 1e-300, 1e-17}) {
    EXPECT_NEAR(layer({k, 3}, 2).reflectance, 6.0 / 7.0, 1e-14);
    EXPECT_NEAR(layer({k, 3}, 2).transmittance, 1.0 / 7.0, 1e-14);
  }
  EXPECT_NEAR(opaque_reflectance(0.5), (3 - std::sqrt(5.0)) / 2, 1e-15);  // .381966
  EXPECT_EQ(opaque_reflectance(0), 1);
  EXPECT_EQ(opaque_reflectance(kInfinity), 0);
  EXPECT_NEAR(opaque_reflectance(1e9) * 2e9, 1, 1e-8);
  // Thick layers, finite beyond what hyperbolic functions can hold.
  for (const double thickness : {1e3, 1e6, 1e300, kInfinity}) {
    EXPECT_NEAR(layer({1, 2}, thickness).reflectance, opaque_reflectance(0.5), 1e-15);
    EXPECT_EQ(layer({1, 2}, thickness).transmittance < 1e-300, true);
  }
  EXPECT_EQ(layer({0, 2}, kInfinity).reflectance, 1);
  // Thin layers: first order in the thickness.
  EXPECT_NEAR(layer({1, 2}, 1e-9).reflectance / 2e-9, 1, 1e-8);
  EXPECT_NEAR((1 - layer({1, 2}, 1e-6).transmittance) / 3e-6, 1, 1e-5);
  EXPECT_EQ(layer({1, 2}, 0).reflectance, 0);
  EXPECT_EQ(layer({1, 2}, 0).transmittance, 1);
  EXPECT_EQ(reflectance_over(layer({1, 2}, 0), 0.37), 0.37);
}

TEST(KubelkaMunk, LayersOfOnePaintAddUp) {
  const Coefficients c{0.4, 1.3};
  const LayerTransfer whole = layer(c, 2), parts = stacked(layer(c, 0.3), layer(c, 1.7));
  EXPECT_NEAR(whole.reflectance, parts.reflectance, 1e-15);
  EXPECT_NEAR(whole.transmittance, parts.transmittance, 1e-15);
}

TEST(KubelkaMunkInverse, ComesBack) {
  for (const Coefficients c :
       {Coefficients{0.3, 2}, {2, 0.3}, {0, 1}, {1, 0}, {1e-4, 1.5}, {0.7, 1e-6}, {5, 5}, {0.01, 30}})
    for (const double thickness : {0.02, 0.5, 2.0}) {
      const auto same = [&](Coefficients found, const char* how) {
        EXPECT_NEAR(found.k, c.k, 1e-9 * (c.k + 0.1 * c.s))
            << how << " " << c.k << " " << c.s << " " << thickness;
        EXPECT_NEAR(found.s, c.s, 1e-9 * (c.s + 0.1 * c.k))
            << how << " " << c.k << " " << c.s << " " << thickness;
      };
      const LayerTransfer t = layer(c, thickness);
      same(coefficients_of_transfer(t, thickness), "R and T");
      const auto over = [&](double substrate) { return Drawdown{reflectance_over(t, substrate), substrate}; };
      if (t.transmittance > 1e-2) {
        same(coefficients_of_drawdowns(over(0), over(1), thickness), "black and white");
        same(coefficients_of_drawdowns(over(0.04), over(0.8), thickness), "dark and light");
      }
      const double deep = opaque_reflectance(c.ratio());
      if (deep > 1e-3 && deep < 0.99 && t.transmittance > 1e-2)
        for (const double substrate : {0.0, 0.9})
          same(coefficients_of_opaque(deep, over(substrate), thickness), "opaque and a drawdown");
    }
}

TEST(KubelkaMunkInverse, SmallCoefficientsKeepTheirDigits) {
  // K has as many digits as 1 - R - T: an absorbed fraction of 1e-6 is known to 1e-10.
  const Coefficients weak = coefficients_of_transfer(layer({1e-6, 1}, 1), 1);
  EXPECT_NEAR(weak.k / 1e-6, 1, 1e-9);
  EXPECT_NEAR(weak.s, 1, 1e-9);
  const Coefficients clear = coefficients_of_transfer({0, 0.25}, 2);
  EXPECT_NEAR(clear.k, std::log(2.0), 1e-15);
  EXPECT_EQ(clear.s, 0);
}

TEST(KubelkaMunkInverse, TintWithWhite) {
  const Coefficients white{0.02, 1}, red{0.6, 0.35};
  const double share = 0.15;
  const double tint = (share * red.k + (1 - share) * white.k) / (share * red.s + (1 - share) * white.s);
  EXPECT_NEAR(scattering_of_tint(red.ratio(), {share, tint}, white), red.s, 1e-14);
  // A tint darker than its masstone has no answer but a negative one.
  EXPECT_LT(scattering_of_tint(red.ratio(), {share, 2.0}, white), 0);
  EXPECT_FALSE(std::isfinite(scattering_of_tint(red.ratio(), {share, red.ratio()}, white)));
}

TEST(KubelkaMunkInverse, ImpossibleDataAreNamed) {
  EXPECT_THROW(coefficients_of_transfer({0.6, 0.5}, 1), std::domain_error);
  EXPECT_THROW(coefficients_of_transfer({0.6, 0.3}, 0), std::domain_error);
  EXPECT_THROW(coefficients_of_transfer({0.6, 0}, 1), std::domain_error);
  EXPECT_THROW(coefficients_of_drawdowns({0.5, 0}, {0.5, 1}, 1), std::domain_error);  // hides
  EXPECT_THROW(coefficients_of_drawdowns({0.3, 0.5}, {0.5, 0.5}, 1), std::domain_error);
  EXPECT_THROW(coefficients_of_opaque(0.5, {0.6, 0}, 1), std::domain_error);
  EXPECT_THROW(coefficients_of_opaque(1, {0.6, 0}, 1), std::domain_error);
  EXPECT_THROW(scattering_of_tint(1, {1, 0.5}, {0, 1}), std::domain_error);
  EXPECT_THROW(layer({-1, 1}, 1), std::domain_error);
  EXPECT_THROW(layer({1, std::nan("")}, 1), std::domain_error);
  EXPECT_THROW(layer({1, 1}, -1), std::domain_error);
  EXPECT_THROW(k_over_s(0), std::domain_error);
  EXPECT_THROW(reflectance_over({0.2, 0.4}, 1.1), std::domain_error);
  EXPECT_THROW(fluxes_within({1, 1}, 1, 0, 2), std::domain_error);
}

TEST(TransportConventions, HalfSpacesNearTransport) {
  // R_inf of isotropic scatterers for diffuse light by transport, and by each convention, three digits each.
  const double albedo[] = {0.5, 0.9, 0.99}, exact[] = {0.1465, 0.478, 0.795};
  const double expected[3][3] = {{0.139, 0.471, 0.793}, {0.101, 0.465, 0.793}, {0.172, 0.520, 0.818}};
  for (const Convention convention : conventions())
    for (std::size_t i = 0; i < 3; ++i) {
      const Coefficients c = coefficients_of_transport(1 - albedo[i], albedo[i], 0, convention);
      EXPECT_EQ(c.k, 2 * (1 - albedo[i]));
      const double r = opaque_reflectance(c.ratio());
      EXPECT_NEAR(r, expected[int(convention)][i], 6e-4) << name_of(convention);
      RecordProperty(std::string(name_of(convention)) + "_error_at_" + std::to_string(albedo[i]),
                     std::to_string(r / exact[i] - 1));
    }
  EXPECT_LT(coefficients_of_transport(1, 0.2, 0, Convention::diffusion).s, 0);
  EXPECT_NEAR(coefficients_of_transport(1, 4, 0.8, Convention::double_gauss).s, 1.6, 1e-15);
  EXPECT_THROW(coefficients_of_transport(1, 4, 1.8), std::domain_error);
  for (const Convention convention : conventions()) {
    const TransportCoefficients back =
        transport_of_coefficients(coefficients_of_transport(0.3, 7, 0.4, convention), 0.4, convention);
    EXPECT_NEAR(back.sigma_a, 0.3, 1e-15) << name_of(convention);
    EXPECT_NEAR(back.sigma_s, 7, 1e-13) << name_of(convention);
  }
  EXPECT_THROW(transport_of_coefficients({1, 1}, 1), std::domain_error);
  EXPECT_THROW(transport_of_coefficients({-1, 1}, 0), std::domain_error);
}

}  // namespace
}  // namespace aureole::pigment
