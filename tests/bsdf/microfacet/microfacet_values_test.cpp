// SPDX-License-Identifier: Apache-2.0
// The rough BSDFs against values of Mitsuba 3.9.1 (scalar_spectral; wi at azimuth 0.2).
#include <gtest/gtest.h>

#include <cmath>

#include "aureole/bsdf/microfacet/microfacet_energy.h"
#include "aureole/optics/interface/fresnel_equations.h"
#include "harness/properties_builder.h"

namespace aureole {
namespace {

using testing::build;

Vec3 direction(double theta, double phi) {
  return {float(std::sin(theta) * std::cos(phi)), float(std::sin(theta) * std::sin(phi)),
          float(std::cos(theta))};
}

struct Setting {
  Wavelengths wavelengths = Wavelengths::at(SpectralGrid::over(360, 830), 550.f);
  SurfacePoint point;
  BsdfContext context() const { return {wavelengths, point, TransportMode::radiance, 0}; }
};

std::string number(const char* name, double v) {
  return std::string("<float name=\"") + name + "\" value=\"" + std::to_string(v) + "\"/>";
}

/// Values, and densities with and without `sample_visible`. Mitsuba's masking of Beckmann surfaces is an
/// approximation to .35 %.
TEST(RoughValues, SingleScattering) {
  struct Row {
    const char *type, *distribution;
    double alpha_u, alpha_v, theta_i, theta_o, phi_o, value, pdf, pdf_all;
  };
  constexpr Row kRows[] = {
      {"roughconductor", "beckmann", 0.1, 0.1, 0.3, 0.5, 3.0, 1.813257, 1.926059, 1.978209},
      {"roughconductor", "beckmann", 0.1, 0.1, 1.2, 1.0, 3.3, 6.499657, 6.95457, 5.518845},
      {"roughconductor", "beckmann", 0.5, 0.5, 1.2, 1.0, 3.3, 0.750228, 0.8063148, 0.6808334},
      {"roughconductor", "beckmann", 0.5, 0.5, 0.7, 1.3, 1.5, 0.004145234, 0.005112962, 0.002945395},
      {"roughconductor", "beckmann", 0.1, 0.4, 0.3, 0.5, 3.0, 0.7078238, 0.751857, 0.7722144},
      {"roughconductor", "beckmann", 0.1, 0.4, 1.2, 1.0, 3.3, 2.229401, 2.385437, 1.892979},
      {"roughconductor", "ggx", 0.1, 0.1, 0.7, 1.3, 1.5, 0.002503932, 0.002744942, 0.001584063},
      {"roughconductor", "ggx", 0.5, 0.5, 1.2, 1.0, 3.3, 0.5144555, 0.6240675, 0.6510103},
      {"roughconductor", "ggx", 0.5, 0.5, 0.7, 1.3, 1.5, 0.03057196, 0.04971461, 0.02985687},
      {"roughconductor", "ggx", 0.1, 0.4, 0.3, 0.5, 3.0, 0.4806451, 0.5110399, 0.5250767},
      {"roughconductor", "ggx", 0.1, 0.4, 0.7, 1.3, 1.5, 0.004044505, 0.005912916, 0.003415811},
      {"roughdielectric", "beckmann", 0.2, 0.2, 0.3, 0.5, 3.0, 0.05971841, 0.05971841, 0.06098901},
      {"roughdielectric", "beckmann", 0.2, 0.2, 0.9, 2.5, 3.3, 8.941345, 20.11803, 16.16199},
      {"roughdielectric", "beckmann", 0.5, 0.5, 2.5, 0.7, 3.2, 4.779375, 2.124166, 1.504951},
      {"roughdielectric", "beckmann", 0.5, 0.5, 2.2, 2.4, 3.5, 0.5214115, 0.5214115, 0.4180333},
      {"roughdielectric", "beckmann", 0.15, 0.4, 0.9, 2.5, 3.3, 2.667872, 6.002712, 5.140801},
      {"roughdielectric", "beckmann", 0.15, 0.4, 2.5, 0.7, 3.2, 0.0001101003, 4.893347e-05, 5.673523e-05},
      {"roughdielectric", "ggx", 0.2, 0.2, 0.3, 0.5, 3.0, 0.04580927, 0.04594559, 0.04704015},
      {"roughdielectric", "ggx", 0.2, 0.2, 0.9, 2.5, 3.3, 5.95537, 13.47394, 10.98458},
      {"roughdielectric", "ggx", 0.5, 0.5, 2.5, 0.7, 3.2, 3.241379, 1.501885, 1.084589},
      {"roughdielectric", "ggx", 0.5, 0.5, 2.2, 2.4, 3.5, 0.4201646, 0.4411509, 0.3932562},
      {"roughdielectric", "ggx", 0.15, 0.4, 0.9, 2.5, 3.3, 2.068891, 4.671779, 3.87815},
      {"roughdielectric", "ggx", 0.15, 0.4, 2.5, 0.7, 3.2, 0.4483444, 0.2000726, 0.1441108}};
  const Setting s;
  for (const Row& r : kRows) {
    const bool metal = r.type == std::string("roughconductor");
    const std::string head =
        std::string("<bsdf type=\"") + r.type + "\"><string name=\"distribution\" value=\"" + r.distribution +
        "\"/>" + number("alpha_u", r.alpha_u) + number("alpha_v", r.alpha_v) +
        (metal ? number("eta", 0.2) + number("k", 3.5) : number("int_ior", 1.5) + number("ext_ior", 1));
    const auto visible = build<Bsdf>(head + "</bsdf>");
    const auto all = build<Bsdf>(head + "<boolean name=\"sample_visible\" value=\"false\"/></bsdf>");
    const Vec3 wi = direction(r.theta_i, 0.2), wo = direction(r.theta_o, r.phi_o);
    const BsdfEval v = visible->eval_pdf(wi, wo, s.context()), a = all->eval_pdf(wi, wo, s.context());
    SCOPED_TRACE(std::string(r.type) + " " + r.distribution + " " + std::to_string(r.value));
    const double masking = r.distribution == std::string("ggx") ? 1e-4 : 0.0035;
    EXPECT_NEAR(v.value[0] / r.value, 1, 2 * masking + 1e-3 * (r.value < 1e-3));
    EXPECT_NEAR(v.pdf[0] / r.pdf, 1, masking + 1e-3 * (r.value < 1e-3));
    EXPECT_NEAR(a.pdf[0] / r.pdf_all, 1, 1e-4 + 1e-3 * (r.value < 1e-3));
    EXPECT_EQ(a.value[0], v.value[0]);
  }
}

/// Reflected fraction of the light from a direction of cosine mu, as the integral of F G1(wi) G1(wo) D(m)
/// (wi.m)/wi.z over the facets' normals by midpoints in their slopes.
double scattered_reflectance(const Microfacets& d, double mu, float eta) {
  constexpr int kRadii = 160, kAngles = 50;
  const Vec3 wi{float(std::sqrt(1 - mu * mu)), 0, float(mu)};
  double sum = 0;
  for (int i = 0; i < kRadii; ++i) {
    const double t = (i + 0.5) / kRadii, r = d.alpha_u() * t / (1 - t);
    for (int j = 0; j < kAngles; ++j) {
      const double phi = M_PI * (j + 0.5) / kAngles;  // the other half is its mirror image
      const double x = r * std::cos(phi), y = r * std::sin(phi), z = 1 / std::sqrt(1 + x * x + y * y);
      const Vec3 m{float(x * z), float(y * z), float(z)};
      const float cos_im = dot(wi, m);
      if (!(cos_im > 0)) continue;
      const Vec3 wo = 2 * cos_im * m - wi;
      if (!(wo.z > 0)) continue;
      // dm = cos^3 dx dy, and r dr = alpha r dt / (1 - t)^2.
      const double solid_angle =
          z * z * z * d.alpha_u() * r / ((1 - t) * (1 - t)) / kRadii * 2 * M_PI / kAngles;
      sum += optics::fresnel_reflectance(std::min(cos_im, 1.f), 1, eta) * d.density(m) * cos_im *
             d.masking_over_cos(wi) * d.masking(wo) * solid_angle;
    }
  }
  return sum;
}

/// Mitsuba takes the mean of 64 equidistant values of 2 R mu for the internal reflectance F_int, both ends
/// with full weight: 2 % less than the integral. With its mean in place of ours all values agree.
TEST(RoughValues, PlasticButForMitsubasInternalReflectance) {
  struct Row {
    const char* distribution;
    double alpha, theta_i, theta_o, phi_o, specular, linear, nonlinear;
  };
  constexpr Row kRows[] = {{"beckmann", 0.1, 1.2, 0.9, 3.2, 0.04730161, 0.1302689, 0.09630144},
                           {"beckmann", 0.1, 1.4, 1.3, 2.0, 0, 0.02187623, 0.01291994},
                           {"beckmann", 0.3, 0.3, 0.5, 1.0, 0.008980215, 0.1301265, 0.0864512},
                           {"beckmann", 0.3, 1.2, 0.9, 3.2, 0.1525115, 0.2268379, 0.200042},
                           {"beckmann", 0.7, 0.3, 0.5, 1.0, 0.006617745, 0.09217287, 0.07418675},
                           {"ggx", 0.1, 0.3, 0.5, 1.0, 0.001663184, 0.1288344, 0.08036766},
                           {"ggx", 0.1, 1.4, 1.3, 2.0, 0.0003084522, 0.02279559, 0.01422543},
                           {"ggx", 0.3, 1.2, 0.9, 3.2, 0.09867425, 0.1565353, 0.1413919},
                           {"ggx", 0.7, 0.3, 0.5, 1.0, 0.005013384, 0.06869091, 0.0616063},
                           {"ggx", 0.7, 1.2, 0.9, 3.2, 0.02069159, 0.05216346, 0.04866197}};
  std::pair<std::string, double> last;
  double mitsuba = 0, integral = 0;
  const Setting s;
  for (const Row& r : kRows) {
    SCOPED_TRACE(std::string(r.distribution) + " " + std::to_string(r.alpha));
    const Microfacets d(
        r.distribution == std::string("ggx") ? NormalDistribution::ggx : NormalDistribution::beckmann,
        float(r.alpha), float(r.alpha));
    if (r.distribution != last.first || r.alpha != last.second) {
      last = {r.distribution, r.alpha};
      const auto reflectance = [&](double mu) {
        return scattered_reflectance(d, std::max(mu, 1e-6), 1 / 1.5f);
      };
      mitsuba = integral = 0;
      for (int i = 0; i < 64; ++i) mitsuba += 2 * reflectance(i / 63.0) * (i / 63.0) / 64;
      constexpr int kSteps = 120;
      for (int i = 0; i < kSteps; ++i) {
        const double mu = (i + 0.5) / kSteps;
        integral += 2 * reflectance(mu) * mu / kSteps;
      }
      EXPECT_NEAR(diffuse_scattered_energy(d, 1 / 1.5f).reflected, integral, 3e-4);
    }

    const Vec3 wi = direction(r.theta_i, 0.2), wo = direction(r.theta_o, r.phi_o);
    for (const bool nonlinear : {false, true}) {
      const auto bsdf = build<Bsdf>(
          std::string("<bsdf type=\"roughplastic\"><string name=\"distribution\" value=\"") + r.distribution +
          "\"/>" + number("alpha", r.alpha) + number("int_ior", 1.5) + number("ext_ior", 1) +
          "<boolean name=\"nonlinear\" value=\"" + (nonlinear ? "true" : "false") + "\"/></bsdf>");
      const double value = bsdf->eval(wi, wo, s.context())[0], rho = nonlinear ? 0.5 : 1;
      const double theirs = nonlinear ? r.nonlinear : r.linear;
      const double expected = r.specular + (theirs - r.specular) * (1 - rho * mitsuba) / (1 - rho * integral);
      EXPECT_NEAR(value / expected, 1, 0.004) << nonlinear;
      if (!nonlinear && r.alpha == 0.1) {
        EXPECT_GT(expected, r.specular + 1.015 * (theirs - r.specular));
      }
    }
  }
}

}  // namespace
}  // namespace aureole
