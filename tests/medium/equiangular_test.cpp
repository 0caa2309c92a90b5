// SPDX-License-Identifier: Apache-2.0
// Places along a segment that are chosen by a light near it: their density, and pictures against quadratures.
#include "aureole/transport/equiangular.h"

#include <gtest/gtest.h>

#include <numbers>

#include "harness/rendered.h"
#include "medium/scene_text.h"

namespace aureole::testing {
namespace {

TEST(Equiangular, SamplesHaveTheirDensity) {
  struct Case {
    Vec3 pivot;
    float t_max, radius;
  };
  for (const Case& c : {Case{{0.3f, 0, 2}, 5, 0}, Case{{0, 1, -3}, 4, 0}, Case{{0.01f, 0, 9}, 2, 0.5f},
                        Case{{2, 1, 3}, kInfinity, 0}, Case{{0, 0, 3}, 10, 0.1f}}) {
    const Equiangular places({{0, 0, 0}, {0, 0, 1}}, c.t_max, c.pivot, c.radius);
    ASSERT_TRUE(places.is_valid());
    // The density is the derivative of the inverse of `sample`.
    float last = 0;
    for (int i = 1; i < 99; ++i) {
      const float u = float(i) / 100, h = 1e-3f;
      const float t = places.sample(u);
      ASSERT_GE(t, last);
      ASSERT_LE(t, c.t_max);
      last = t;
      const float inverse_pdf = (places.sample(u + h) - places.sample(u - h)) / (2 * h);
      EXPECT_NEAR(places.pdf(t) * inverse_pdf, 1, 0.02) << t;
    }
  }
}

/// Radiance of single scattering along the y axis from y = -5, in a ball of radius 6, of a point of intensity 1
/// at (x, y, 0), by Simpson's rule in the angle seen from the point, where the integrand is smooth.
double airlight(double x, double y, double sigma_t, double sigma_s, double g) {
  const int n = 2000;
  const double from = std::atan((-5 - y) / x), to = std::atan((6 - y) / x);
  double sum = 0;
  for (int i = 0; i <= n; ++i) {
    const double angle = from + (to - from) * i / n, r = x / std::cos(angle);
    const double t = y + x * std::tan(angle) + 5;
    // The ray looks along +y; light comes from the point.
    const double cosine = -(std::sin(angle));
    const double phase = (1 - g * g) / (4 * std::numbers::pi * std::pow(1 + g * g - 2 * g * cosine, 1.5));
    sum += (i == 0 || i == n ? 1 : i % 2 ? 4 : 2) * phase * std::exp(-sigma_t * (t + r)) / x;
  }
  return sigma_s * sum * (to - from) / n / 3;
}

TEST(Equiangular, AirlightOfAPoint) {
  struct Case {
    double x, y, sigma_t, g;
  };
  for (const Case& c : {Case{0.02, 0, 0.05, 0}, Case{0.2, -2, 0.4, 0.6}, Case{0.5, 3, 0.01, -0.4},
                        Case{0.1, -4, 3, 0.3}, Case{2, 1, 0.3, 0.8}}) {
    const double sigma_s = 0.8 * c.sigma_t;
    const Picture p =
        render(path(1) +
               "<sensor type=\"radiancemeter\"><point name=\"origin\" x=\"0\" y=\"-5\" z=\"0\"/><vector "
               "name=\"direction\" x=\"0\" y=\"1\" z=\"0\"/>" +
               film(1, 256) + "</sensor><shape type=\"sphere\"><float name=\"radius\" value=\"6\"/>" + kNull +
               medium(c.sigma_t - sigma_s, sigma_s, c.g) +
               "</shape><emitter type=\"point\"><point name=\"position\" x=\"" + number(c.x) + "\" y=\"" +
               number(c.y) + "\" z=\"0\"/></emitter>");
    expect_mean(p, airlight(c.x, c.y, c.sigma_t, sigma_s, c.g), 0.01);
  }
}

}  // namespace
}  // namespace aureole::testing
