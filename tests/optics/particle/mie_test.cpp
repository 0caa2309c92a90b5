// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <boost/math/special_functions/bessel.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "aureole/optics/particle/mie_sphere.h"

namespace aureole::optics {
namespace {

using Complex = std::complex<double>;
constexpr double kPi = std::numbers::pi;

TEST(Mie, PublishedValues) {
  // Wiscombe, "Mie scattering calculations: advances in technique and fast, vector-speed computer codes",
  // NCAR/TN-140+STR (1979), and Du, "Mie-scattering calculation", Applied Optics 43 (2004) 1951.
  const struct {
    double x;
    Complex m;
    double extinction, extinction_digit, scattering, scattering_digit, g;
  } cases[] = {
      {0.099, 0.75, 7.417859e-6, 1e-12, 7.417859e-6, 1e-12, 0.001448},
      {10, 0.75, 2.232265, 1e-6, 2.232265, 1e-6, 0.896473},
      {1000, 0.75, 1.997908, 1e-6, 1.997908, 1e-6, 0.844944},
      {100, {1.33, 1e-5}, 2.101321, 1e-6, 2.096594, 1e-6, 0.868959},
      {1e4, {1.33, 1e-5}, 2.004089, 1e-6, 1.723857, 1e-6, 0.907840},
      {1, {1.5, 1}, 2.336321, 1e-6, 0.6634538, 1e-7, 0.192136},
      {1e4, {10, 10}, 2.005914, 1e-6, 1.795393, 1e-6, 0.548194},
  };
  for (const auto& c : cases) {
    const Mie sphere(c.x, c.m);
    EXPECT_NEAR(sphere.extinction(), c.extinction, 0.51 * c.extinction_digit) << c.x;
    EXPECT_NEAR(sphere.scattering(), c.scattering, 0.51 * c.scattering_digit) << c.x;
    EXPECT_NEAR(sphere.asymmetry(), c.g, 0.51e-6) << c.x;
  }
}

/// a_n and b_n by Bohren & Huffman's equation 4.53 with Bessel functions of another library, real m.
TEST(Mie, CoefficientsByBesselFunctions) {
  const auto psi = [](int n, double z) { return z * boost::math::sph_bessel(unsigned(n), z); };
  const auto chi = [](int n, double z) { return -z * boost::math::sph_neumann(unsigned(n), z); };
  const auto slope = [](const auto& f, int n, double z) { return f(n - 1, z) - n / z * f(n, z); };
  for (const double x : {0.3, 1.0, 4.7, 20.0, 55.5})
    for (const double m : {0.75, 1.1, 1.33, 2.4}) {
      const Mie sphere(x, m);
      for (int n = 1; n <= std::min(int(x + 5), int(sphere.a().size())); ++n) {
        const auto xi = [&](int k, double z) { return Complex(psi(k, z), -chi(k, z)); };
        const double inner = psi(n, m * x), inner_slope = slope(psi, n, m * x);
        const Complex outer = xi(n, x), outer_slope = xi(n - 1, x) - n / x * outer;
        const Complex a = (m * inner * slope(psi, n, x) - psi(n, x) * inner_slope) /
                          (m * inner * outer_slope - outer * inner_slope);
        const Complex b = (inner * slope(psi, n, x) - m * psi(n, x) * inner_slope) /
                          (inner * outer_slope - m * outer * inner_slope);
        EXPECT_LT(std::abs(sphere.a()[n - 1] - a), 1e-9 * std::abs(a) + 1e-13) << x << " " << m << " " << n;
        EXPECT_LT(std::abs(sphere.b()[n - 1] - b), 1e-9 * std::abs(b) + 1e-13) << x << " " << m << " " << n;
      }
    }
}

TEST(Mie, RayleighLimit) {
  for (const Complex m : {Complex(1.33), Complex(0.6), Complex(1.5, 0.8), Complex(3, 2)})
    for (const double x : {1e-6, 1e-4, 1e-3}) {
      const Mie sphere(x, m);
      const Complex k = (m * m - 1.0) / (m * m + 2.0);
      const double scattering = 8.0 / 3 * std::pow(x, 4) * std::norm(k);
      EXPECT_NEAR(sphere.scattering() / scattering, 1, 20 * x * x + 1e-9);
      EXPECT_NEAR(sphere.extinction() / (scattering + 4 * x * k.imag()), 1, 20 * x * x + 1e-9);
      EXPECT_NEAR(sphere.backscattering() / (4 * std::pow(x, 4) * std::norm(k)), 1, 20 * x * x + 1e-9);
      EXPECT_NEAR(sphere.asymmetry(), 0, 2 * x * x + 1e-9);
      for (const double mu : {-1.0, -0.3, 0.0, 0.8}) {
        // S1 = -i x^3 K, S2 = S1 mu.
        const MieAmplitudes s = sphere.amplitudes(mu);
        const Complex expected = Complex(0, -1) * std::pow(x, 3) * k;
        EXPECT_LT(std::abs(s.s1 - expected), (20 * x * x + 1e-9) * std::abs(expected));
        EXPECT_LT(std::abs(s.s2 - mu * expected), (20 * x * x + 1e-9) * std::abs(expected));
      }
    }
}

TEST(Mie, AnomalousDiffraction) {
  // Soft large spheres (van de Hulst, Light Scattering by Small Particles, 1957, section 11.22), also
  // absorbing ones. The next order is m - 1 and x^(-2/3).
  for (const double x : {2000.0, 8000.0})
    for (const double phase : {0.5, 2.0, 4.1, 7.6, 15.0})
      for (const double beta : {0.0, 0.3}) {
        const Complex m = 1.0 + phase / (2 * x) * Complex(1, std::tan(beta));
        const Complex w = Complex(0, -1) * (2 * x * (m - 1.0));
        const Complex k = 0.5 + std::exp(-w) / w + (std::exp(-w) - 1.0) / (w * w);
        EXPECT_NEAR(Mie(x, m).extinction() / (4 * k.real()), 1, 0.012) << x << " " << phase;
      }
  EXPECT_LT(Mie(10, 1).extinction(), 1e-25);
  EXPECT_EQ(Mie(10, 1).backscattering(), 0);
  // To first order in m - 1 everything is proportional to |m - 1|^2.
  EXPECT_NEAR(Mie(10, 1 + 1e-6).extinction() / Mie(10, 1 + 1e-4).extinction() * 1e4, 1, 1e-3);
}

struct Quadrature {
  std::vector<double> nodes, weights;
};
/// Gauss and Legendre; exact up to degree 2 n - 1.
Quadrature gauss_legendre(int n) {
  Quadrature q;
  for (int i = 0; i < n; ++i) {
    double z = std::cos(kPi * (i + 0.75) / (n + 0.5)), slope = 0;
    for (int iteration = 0; iteration < 100; ++iteration) {
      double p = 1, before = 0;
      for (int k = 0; k < n; ++k) {
        const double next = ((2 * k + 1) * z * p - k * before) / (k + 1);
        before = p, p = next;
      }
      slope = n * (z * p - before) / (z * z - 1);
      const double step = p / slope;
      z -= step;
      if (std::abs(step) < 1e-15) break;
    }
    q.nodes.push_back(z);
    q.weights.push_back(2 / ((1 - z * z) * slope * slope));
  }
  return q;
}

TEST(Mie, AmplitudesCarryTheCrossSections) {
  for (const double x : {0.01, 1.0, 11.0, 100.0, 300.0})
    for (const Complex m : {Complex(1.33), Complex(0.75), Complex(1.5, 0.02), Complex(2, 1)}) {
      const Mie sphere(x, m);
      // |S|^2 is a polynomial of degree 2 count.
      const Quadrature q = gauss_legendre(int(sphere.a().size()) + 2);
      std::vector<MieAmplitudes> s(q.nodes.size());
      sphere.amplitudes(q.nodes, s);
      double scattering = 0, cosine = 0;
      for (std::size_t i = 0; i < s.size(); ++i) {
        const double both = q.weights[i] * 2 * s[i].intensity() / (x * x);
        scattering += both, cosine += both * q.nodes[i];
      }
      EXPECT_NEAR(scattering / sphere.scattering(), 1, 1e-9) << x << m;
      EXPECT_NEAR(cosine / scattering, sphere.asymmetry(), 1e-9) << x << m;
      // The optical theorem, and what is scattered backwards.
      const MieAmplitudes forward = sphere.amplitudes(1), backward = sphere.amplitudes(-1);
      EXPECT_NEAR(4 / (x * x) * forward.s1.real() / sphere.extinction(), 1, 1e-10) << x << m;
      EXPECT_LT(std::abs(forward.s1 - sphere.forward()), 1e-11 * std::abs(sphere.forward()));
      EXPECT_LT(std::abs(forward.s2 - sphere.forward()), 1e-11 * std::abs(sphere.forward()));
      EXPECT_LT(std::abs(backward.s1 + backward.s2), 1e-9 * std::abs(sphere.forward()));
      EXPECT_NEAR(4 * std::norm(backward.s1) / (x * x), sphere.backscattering(),
                  1e-8 * sphere.backscattering() + 1e-14 * sphere.extinction() * x * x);
      if (m.imag() == 0) {
        EXPECT_NEAR(sphere.albedo(), 1, 1e-9);
      } else {
        EXPECT_LT(sphere.albedo(), 1);
      }
    }
}

TEST(Mie, MirroredAmplitudesAreThoseOfTheOppositeCosine) {
  const Mie sphere(37.3, {1.4, 0.01});
  std::vector<double> mu;
  for (int i = 0; i < 23; ++i) mu.push_back(i / 22.0);  // no multiple of a vector's length
  std::vector<MieAmplitudes> at(mu.size()), mirrored(mu.size());
  sphere.amplitudes(mu, at, mirrored);
  for (std::size_t i = 0; i < mu.size(); ++i) {
    const MieAmplitudes a = sphere.amplitudes(mu[i]), b = sphere.amplitudes(-mu[i]);
    EXPECT_LT(std::abs(at[i].s1 - a.s1) + std::abs(at[i].s2 - a.s2), 1e-12 * std::abs(sphere.forward()));
    EXPECT_LT(std::abs(mirrored[i].s1 - b.s1) + std::abs(mirrored[i].s2 - b.s2),
              1e-12 * std::abs(sphere.forward()));
  }
}

TEST(Mie, LargestSpheres) {
  // The extinction paradox, and its next term, 1.9924 x^(-2/3) (Nussenzveig & Wiscombe 1980).
  for (const double x : {1e4, 1e5}) {
    const Mie sphere(x, {1.5, 0.1});
    EXPECT_NEAR(sphere.extinction(), 2 + 1.9924 * std::pow(x, -2.0 / 3), 2e-5) << x;
  }
  const Mie clear(1e5, 1.33);
  EXPECT_NEAR(clear.albedo(), 1, 1e-9);
  EXPECT_NEAR(4e-10 * clear.amplitudes(1).s2.real(), clear.extinction(), 1e-8);
}

TEST(Mie, BadInputIsNamed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto fails_with = [](double x, Complex m, const std::string& part) {
    try {
      const Mie sphere(x, m);
      ADD_FAILURE() << x << m;
    } catch (const std::domain_error& e) {
      EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
    }
  };
  fails_with(0, 1.5, "0.000000");
  fails_with(-2, 1.5, "-2.0");
  fails_with(2e5, 1.5, "200000");
  fails_with(nan, 1.5, "nan");
  fails_with(1, 0, "0.0");
  fails_with(1, {1.5, -0.25}, "-0.25");
  fails_with(1, 101, "101");
  fails_with(1, {1, nan}, "nan");
}

}  // namespace
}  // namespace aureole::optics
