// SPDX-License-Identifier: Apache-2.0
// The phase function of spheres against a published table, closed forms of the rainbow, and the limit of
// small spheres.
#include <gtest/gtest.h>

#include <cmath>

#include "aureole/phase/phase.h"
#include "harness/phase_harness.h"
#include "harness/properties_builder.h"

namespace aureole::testing {
namespace {

PhaseCase peaked(std::string name, std::string xml, double angle) {
  PhaseCase c(std::move(name), std::move(xml));
  has_peaks(c, angle);
  return c;
}

const PhaseCases kMie("mie", [](PhaseCase& c) { has_peaks(c, 0.03); },
                      {peaked("mie_one_size", R"(<phase type="mie"><string name="radius" value="1.5um"/>
               <float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/></phase>)",
                              0.02),
                       peaked("mie_metal", R"(<phase type="mie"><string name="radius" value="80nm"/>
               <string name="int_ior" value="Au"/><string name="ext_ior" value="water"/></phase>)",
                              0.1)});

std::shared_ptr<PhaseFunction> mie(const std::string& parameters, double min_nm, double max_nm) {
  return build<PhaseFunction>("<phase type=\"mie\">" + parameters + "</phase>", make_context(min_nm, max_nm));
}
double value(const PhaseFunction& phase, double degrees, double nm) {
  const Wavelengths w = Wavelengths::at(phase.properties().context().grid, float(nm));
  const double a = degrees * M_PI / 180;
  return double(phase.eval_pdf({0, 0, -1}, {float(std::sin(a)), 0, float(std::cos(a))}, {w, {}}).value[0]);
}

// The sample run of program BHMIE: radius 0.525 um, index 1.55, 632.8 nm. S11 over its value straight on
// (Bohren & Huffman, Absorption and Scattering of Light by Small Particles, 1983, appendix A).
TEST(MiePhase, AgreesWithBohrenAndHuffman) {
  constexpr double kValues[] = {1.0,        0.785390,   0.356897,   0.0766119,  0.0355355, 0.0701845,
                                0.0574313,  0.0219660,  0.0125959,  0.0173750,  0.0124601, 0.00679093,
                                0.00954239, 0.00863419, 0.00227421, 0.00543998, 0.0160243, 0.0188852,
                                0.0195254,  0.0301676,  0.0383189};
  const auto phase = mie(R"(<string name="radius" value="0.525um"/><float name="int_ior" value="1.55"/>
      <float name="ext_ior" value="1"/>)",
                         632.8, 640);
  const double top = value(*phase, 0, 632.8);
  for (int i = 0; i <= 20; ++i)
    EXPECT_NEAR(value(*phase, 9 * i, 632.8) / top / kValues[i], 1, 0.012) << 9 * i << " degrees";
}

TEST(MiePhase, SmallSpheresScatterAsRayleighSays) {
  const auto phase = mie(R"(<string name="radius" value="5nm"/><float name="int_ior" value="1.33"/>
      <float name="ext_ior" value="1"/>)",
                         360, 830);
  for (const double nm : {400.0, 777.0})
    for (const double degrees : {0.0, 30.0, 90.0, 130.0, 180.0}) {
      const double mu = std::cos(degrees * M_PI / 180);
      EXPECT_NEAR(value(*phase, degrees, nm) / (3 / (16 * M_PI) * (1 + mu * mu)), 1, 0.015);
    }
}

TEST(MiePhase, FogbowIsWhereAiryHasIt) {
  // Descartes' ray of the first bow: cos^2(i) = (n^2 - 1)/3, the deflection pi + 2 i - 4 r. Airy's bow of
  // droplets of 10 um at 550 nm is 3.87 degrees inside of it; Mie's theory, of light that is polarised
  // across, and a spread of 3 %, gives 3.97.
  constexpr double n = 1.3339;
  const auto phase = mie(R"(<string name="radius" value="10um"/><float name="size_spread" value="0.03"/>
      <float name="int_ior" value="1.3339"/><float name="ext_ior" value="1"/>)",
                         548, 552);
  const double i = std::acos(std::sqrt((n * n - 1) / 3)), r = std::asin(std::sin(i) / n);
  const double descartes = 180 + (2 * i - 4 * r) * 180 / M_PI;
  double best = 0, at = 0;
  for (double a = descartes - 2; a < descartes + 10; a += 0.05)
    if (const double p = value(*phase, a, 550); p > best) best = p, at = a;
  EXPECT_NEAR(at - descartes, 3.97, 0.6);
  EXPECT_GT(best, 2 * value(*phase, descartes - 6, 550));
}

TEST(MiePhase, GlorySurroundsTheWayBack) {
  // The rings around the shadow are there, and their size is that of the wavelength over the radius.
  const auto phase = mie(R"(<string name="radius" value="10um"/><string name="distribution" value="gamma"/>
      <float name="effective_variance" value="0.01"/><float name="int_ior" value="1.333"/>
      <float name="ext_ior" value="1"/>)",
                         548, 552);
  double least = 1e9, ring = 0;
  for (double a = 174; a < 180; a += 0.05) {
    const double p = value(*phase, a, 550);
    if (a < 178.5) ring = std::max(ring, p);
    least = std::min(least, p);
  }
  EXPECT_GT(ring, 1.5 * least);
  EXPECT_GT(value(*phase, 180, 550), 1.5 * value(*phase, 170, 550));
}

TEST(MiePhase, DefaultDropsDisperse) {
  const std::string radius = R"(<string name="radius" value="1um"/>)";
  const auto of = [&](const std::string& index) { return value(*mie(radius + index, 400, 420), 140, 400); };
  const double drop = of("");
  EXPECT_EQ(drop, of(R"(<string name="int_ior" value="water"/>)"));
  EXPECT_NE(drop, of(R"(<boolean name="dispersion" value="false"/>)"));
}

TEST(MiePhase, RefusesWrongInput) {
  const auto expect_error = [](const std::string& parameters, const std::string& text) {
    try {
      mie(parameters, 360, 830);
      ADD_FAILURE() << "took " << parameters;
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find(text), std::string::npos) << e.what();
    }
  };
  const std::string radius = R"(<string name="radius" value="1um"/>)";
  expect_error("", "\"radius\" is required");
  expect_error(R"(<float name="radius" value="1"/>)", "unit");
  expect_error(R"(<string name="radius" value="50mm"/>)", "up to 5000");
  expect_error(radius + R"(<string name="distribution" value="normal"/>)", "log_normal");
  expect_error(radius + R"(<float name="effective_variance" value="0.2"/>)", "no meaning");
  expect_error(radius + R"(<float name="size_spread" value="2"/>)", "in [0, 1.5]");
  expect_error(radius + R"(<string name="int_ior" value="watre"/>)", "water");
  expect_error(R"(<string name="radius" value="0.5mm"/>)", "at the sensor's shortest wavelength");
}

}  // namespace
}  // namespace aureole::testing
