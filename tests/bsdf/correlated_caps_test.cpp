// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstdio>
#include <functional>
#include <memory>
#include <numbers>
#include <string>

#include "aureole/bsdf/bsdf.h"
#include "aureole/optics/arrangement/structure_factor.h"
#include "bsdf/bsdf_test_support.h"
#include "harness/bsdf_harness.h"
#include "harness/effort.h"
#include "harness/properties_builder.h"

namespace aureole {
namespace {

using testing::BsdfCase;
using testing::BsdfCases;
using testing::direction;

constexpr double kPiD = std::numbers::pi;

std::string caps(const std::string& radius, double area_fraction, double degrees,
                 const std::string& more = "") {
  return R"(<bsdf type="correlated_caps"><string name="radius" value=")" + radius +
         R"("/><float name="area_fraction" value=")" + std::to_string(area_fraction) +
         R"("/><float name="contact_angle" value=")" + std::to_string(degrees) + R"("/>)" + more + "</bsdf>";
}
std::string disc(const std::string& radius, double area_fraction, const std::string& height,
                 const std::string& more = "") {
  return R"(<bsdf type="correlated_caps"><string name="radius" value=")" + radius +
         R"("/><float name="area_fraction" value=")" + std::to_string(area_fraction) +
         R"("/><string name="profile" value="disc"/><string name="height" value=")" + height +
         R"("/><float name="int_ior" value="1.4"/><float name="ext_ior" value="1"/>)" + more + "</bsdf>";
}

// Waves without a real direction are not sampled; their light is turned back. Energy is right to what the tables
// over angles and wavelengths resolve: less where the phase of all scatterers is one.
void caps_case(BsdfCase& c, double angle, bool lossless, double tolerance = 0.01) {
  c.may_fail = true;
  c.tolerance = tolerance;
  c.lossless = lossless;
  c.focus = [](const Vec3& wi) { return std::vector<Vec3>{-wi}; };
  c.focus_angle = angle;
}
BsdfCase harness_case(const char* name, const std::string& xml, double angle, bool lossless = true,
                      double tolerance = 0.01) {
  BsdfCase c;
  c.name = name, c.xml = xml;
  caps_case(c, angle, lossless, tolerance);
  return c;
}
const BsdfCases kCaps(
    "correlated_caps", [](BsdfCase& c) { caps_case(c, 0.01, c.name == "correlated_caps_example_1"); },
    testing::with_samples(
        20000, {harness_case("correlated_caps_steep", caps("3um", 0.6, 90), 0.02, true, 0.015),
                harness_case("correlated_caps_shallow",
                             caps("10um", 0.3, 15, R"(<float name="int_ior" value="1.5"/>)"), 0.005),
                harness_case("correlated_caps_phase_discs", disc("2um", 0.5, "1.5um"), 0.03, true, 0.04),
                harness_case("correlated_caps_grey_discs",
                             disc("3um", 0.4, "300nm", R"(<float name="transmittance" value="0.3"/>)"), 0.02,
                             false)}));

/// A sensor so narrow that nodes of the wavelength do not matter.
struct Setting {
  static constexpr double kNm = 550;
  Wavelengths wavelengths = Wavelengths::at(SpectralGrid::over(kNm - 0.01, kNm + 0.01), float(kNm));
  SurfacePoint point;
  std::shared_ptr<Bsdf> build(const std::string& xml) const {
    return testing::build<Bsdf>(xml, testing::make_context(kNm - 0.01, kNm + 0.01));
  }
  BsdfContext context() const { return {wavelengths, point, TransportMode::radiance, 0}; }
};

double airy(double u) { return u < 1e-9 ? 1 : 2 * std::cyl_bessel_j(1, u) / u; }

TEST(CorrelatedCaps, PhaseDiscsAreInClosedForm) {
  // A disc changes light by t = sqrt(T) exp(i psi). Beside the factor that keeps energy, which is common to all
  // directions, J = rho |t - 1|^2 (pi a^2)^2 airy^2 S'.
  const Setting s;
  const double fa = 0.35, radius = 4000, height = 700, transmittance = 0.6;
  const auto bsdf = s.build(disc("4um", fa, "700nm", R"(<float name="transmittance" value="0.6"/>)"));
  const double k = 2 * kPiD / Setting::kNm;
  double first = 0;
  for (const double theta_i : {0.0, 0.5, 1.0})
    for (const double theta : {0.02, 0.06, 0.1, 0.2}) {
      const Vec3 wi = direction(theta_i, 0.3), wo = direction(kPiD - theta_i + theta, 0.3 + kPiD);
      const double u = k * radius * std::hypot(double(wi.x) + wo.x, double(wi.y) + wo.y);
      const double sine = std::hypot(double(wo.x), double(wo.y)),  // the flat side
          difference = std::sqrt(1.4 * 1.4 - sine * sine) - double(wi.z);
      const std::complex<double> t = std::sqrt(transmittance) * std::polar(1.0, k * height * difference);
      const double expected = std::pow(k * radius, 2) / (4 * kPiD * kPiD) * fa / kPiD * std::norm(t - 1.0) *
                              std::pow(kPiD * airy(u), 2) * optics::hard_disc_structure_factor(u, fa) *
                              std::abs(double(wo.z));
      const double value = double(bsdf->eval(wi, wo, s.context())[0]);
      if (first == 0) first = value / expected;
      EXPECT_NEAR(value / first, expected,
                  4e-3 * std::pow(k * radius, 2) / (4 * kPiD) * fa * std::abs(double(wo.z)))
          << theta_i << " " << theta;
      EXPECT_NEAR(value / expected, first, 0.02 * first) << theta_i << " " << theta;
    }
  EXPECT_NEAR(first, 1, 0.02);
  for (const double cosine : {1.0, 0.6}) {
    const Vec3 wi = direction(std::acos(cosine), 1);
    const double difference = std::sqrt(1.96 - 1 + cosine * cosine) - cosine;
    const std::complex<double> t = std::sqrt(transmittance) * std::polar(1.0, k * height * difference);
    EXPECT_NEAR(double(bsdf->null_transmittance(wi, s.context())[0]), std::norm(1.0 + fa * (t - 1.0)), 2e-3);
  }
}

TEST(CorrelatedCaps, LargeDropsLookLikeOpaqueDiscs) {
  // Babinet: near the forward direction the light that drops refract is spread too widely to matter.
  const Setting s;
  const auto drops = s.build(caps("20um", 0.4, 70)),
             discs = s.build(R"(<bsdf type="correlated_scatterers"><string name="scatterer" value="discs"/>
               <string name="radius" value="20um"/><float name="area_fraction" value="0.4"/></bsdf>)");
  const Vec3 wi = direction(0, 0);
  double ratio = 0, most = 0;
  int count = 0;
  for (double theta = 0.004; theta < 0.03; theta += 0.001) {
    const Vec3 wo = direction(kPiD - theta, 0);
    const double a = double(drops->eval(wi, wo, s.context())[0]),
                 b = double(discs->eval(wi, wo, s.context())[0]);
    most = std::max(most, b);
    if (b < 0.2 * most) continue;
    ratio += a / b, ++count;
    EXPECT_NEAR(a / b, 1, 0.35) << theta;
  }
  std::printf("large drops over opaque discs near the lamp: %.3f\n", ratio / count);
  EXPECT_NEAR(ratio / count, 1, 0.08);
  EXPECT_NEAR(double(drops->null_transmittance(wi, s.context())[0]), 0.36, 0.06);
}

TEST(CorrelatedCaps, ThinFilmsOfNothingAreClear) {
  const Setting s;
  const auto none = s.build(disc("4um", 0.4, "1nm"));
  const Vec3 wi = direction(0.3, 0);
  EXPECT_NEAR(double(none->null_transmittance(wi, s.context())[0]), 1, 1e-3);
  EXPECT_LT(double(none->eval(wi, direction(kPiD - 0.3 + 0.05, kPiD), s.context())[0]), 1e-2);
}

TEST(CorrelatedCaps, NoLightIsLostAtAnyAngle) {
  const auto bsdf = testing::build<Bsdf>(caps("5um", 0.5, 60));
  const SurfacePoint point;
  double worst = 0;
  for (const double nm : {420.0, 550.0, 680.0})
    for (const double theta : {0.0, 0.6, 1.1, 1.4, kPiD - 0.3, kPiD - 1.2}) {
      const Wavelengths w = Wavelengths::at(SpectralGrid{}, float(nm));
      const BsdfContext context{w, point, TransportMode::radiance, 0};
      const Vec3 wi = direction(theta, 0.2);
      double sum = double(bsdf->null_transmittance(wi, context)[0]);
      const int rings = test::effort(500, 2000), spokes = test::effort(240, 1500);
      for (int i = 0; i < rings; ++i)
        for (int k = 0; k < spokes; ++k)
          for (const bool up : {false, true}) {
            // Rings about the way straight on, in transverse components.
            const double v = 2 * std::pow((i + 0.5) / rings, 1.5),
                         dv = 2 * 1.5 * std::sqrt((i + 0.5) / rings) / rings,
                         phi = 2 * kPiD * (k + 0.5) / spokes;
            const double x = v * std::cos(phi) - double(wi.x), y = v * std::sin(phi) - double(wi.y),
                         s2 = x * x + y * y;
            if (s2 >= 1) continue;
            const double z = std::sqrt(1 - s2);
            const Vec3 wo{float(x), float(y), float(up ? z : -z)};
            sum += double(bsdf->eval(wi, wo, context)[0]) / z * v * dv * 2 * kPiD / spokes;
          }
      worst = std::max(worst, std::abs(sum - 1));
      EXPECT_NEAR(sum, 1, 0.02) << nm << " " << theta;
    }
  std::printf("largest error of the energy: %.4f\n", worst);
}

TEST(CorrelatedCaps, Errors) {
  const auto refused = [](const std::string& xml, const std::string& message) {
    try {
      testing::build<Bsdf>(xml);
      FAIL() << xml;
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find(message), std::string::npos) << e.what();
    }
  };
  refused(caps("5um", 0.5, 100), "contact_angle");
  refused(caps("5um", 0.8, 60), "area_fraction");
  refused(caps("50nm", 0.5, 60), "too small");
  refused(caps("500um", 0.5, 60), "refract as meshes");
  refused(disc("2um", 0.5, "5mm"), "parameter \"height\"");
  refused(disc("5um", 0.5, "20um"), "too high");
  refused(caps("5um", 0.5, 60, R"(<correlation type="poisson"/>)"), "cannot overlap");
  refused(caps("5um", 0.5, 60, R"(<string name="height" value="1um"/>)"), "is for the profile \"disc\"");
  refused(caps("5um", 0.5, 60, R"(<float name="transmittance" value="0.5"/>)"),
          "is for the profile \"disc\"");
  refused(caps("5um", 0.5, 60, R"(<float name="int_ior" value="0.8"/>)"), "above 1.001");
  refused(
      R"(<bsdf type="correlated_caps"><string name="radius" value="5um"/><float name="area_fraction" value="0.4"/></bsdf>)",
      "\"contact_angle\" is required");
  refused(
      R"(<bsdf type="correlated_caps"><float name="contact_angle" value="50"/><float name="area_fraction" value="0.4"/></bsdf>)",
      "\"radius\" is required");
}

}  // namespace
}  // namespace aureole
