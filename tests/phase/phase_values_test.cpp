// SPDX-License-Identifier: Apache-2.0
// Phase functions against closed forms and against values of Mitsuba 3.9.1 (scalar_rgb), and the texts of
// their errors.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "aureole/phase/phase.h"
#include "harness/properties_builder.h"

namespace aureole {
namespace {

using testing::build;

const SpectralGrid kGrid = SpectralGrid::over(360, 830);
const Wavelengths kWaves =
    Wavelengths::at(kGrid, make_spectrum([](int i) { return 400.f + 50.f * float(i); }));
const PhaseContext kContext{kWaves, {}};

Vec3 direction(double theta, double phi) {
  return {float(std::sin(theta) * std::cos(phi)), float(std::sin(theta) * std::sin(phi)),
          float(std::cos(theta))};
}
std::shared_ptr<PhaseFunction> make(const std::string& type, const std::string& parameters) {
  return build<PhaseFunction>("<phase type=\"" + type + "\">" + parameters + "</phase>");
}
double value(const PhaseFunction& phase, const Vec3& wi, const Vec3& wo) {
  return double(phase.eval_pdf(wi, wo, kContext).value[0]);
}
/// At a cosine of the scattering angle, for light that travels along z.
double value(const PhaseFunction& phase, double mu) {
  const double s = std::sqrt((1 - mu) * (1 + mu));
  return value(phase, {0, 0, -1}, {float(s * std::cos(0.7)), float(s * std::sin(0.7)), float(mu)});
}
/// 2 pi times the integral of f p over mu, by Gauss and Legendre's rule of two points in small cells.
double moment(const PhaseFunction& phase, const std::function<double(double)>& f) {
  constexpr int kCells = 4000;
  constexpr double kPoint = 0.2886751345948129;
  double sum = 0;
  for (int i = 0; i < kCells; ++i)
    for (const double at : {0.5 - kPoint, 0.5 + kPoint}) {
      const double mu = -1 + 2 * (i + at) / kCells;
      sum += f(mu) * value(phase, mu) / kCells;
    }
  return 2 * M_PI * sum;
}
double mean_cosine(const PhaseFunction& phase) {
  return moment(phase, [](double mu) { return mu; });
}

// Values of the four pairs of directions below, with equal parameters in Mitsuba:
//   phase.eval_pdf(mi.PhaseFunctionContext(None), interaction, wo)[0]
TEST(PhaseValues, AgreeWithMitsuba) {
  struct Row {
    const char *type, *parameters;
    double values[4];
  };
  const Row rows[] = {
      {"hg", R"(<float name="g" value="0.6"/>)", {0.2686060965, 0.03126864135, 0.7760766149, 0.01249811519}},
      {"hg",
       R"(<float name="g" value="-0.35"/>)",
       {0.03086687438, 0.05984777957, 0.02841831744, 0.2497242242}},
      {"hg", "", {0.2079705894, 0.01324539632, 3.147324085, 0.004938888364}},
      {"rayleigh", "", {0.1036501825, 0.05970763788, 0.1190983132, 0.1184974685}},
      {"tabphase",
       R"(<string name="values" value="0.5, 0.2, 1, 0.7, 3"/>)",
       {0.2047797292, 0.08437874913, 0.260723263, 0.04322187975}},
      {"blendphase",
       R"(<float name="weight" value="0.3"/><phase type="hg"><float name="g" value="0.6"/></phase>
          <phase type="rayleigh"/>)",
       {0.2191193253, 0.03980034217, 0.5789830685, 0.0442979224}},
      {"sggx",
       R"(<string name="S" value="0.5, 0.9, 0.2, 0.1, -0.15, 0.05"/>)",
       {0.1549794525, 0.0113394903, 0.009348542430, 0.06111327931}}};
  const Vec3 wi[] = {direction(0.3, 0.2), direction(1.2, 0.2), direction(2.0, 1.0), direction(0.7, 3.0)},
             wo[] = {direction(2.9, 0.4), direction(0.5, 2.5), direction(1.1, 4.2), direction(0.8, 3.1)};
  for (const Row& row : rows) {
    const auto phase = make(row.type, row.parameters);
    for (int k = 0; k < 4; ++k) {
      const PhaseEval e = phase->eval_pdf(wi[k], wo[k], kContext);
      EXPECT_NEAR(double(e.value[0]) / row.values[k], 1, 1e-5) << row.type << " " << k;
      for (int j = 0; j < kWavelengths; ++j) EXPECT_EQ(e.value[j], e.pdf[j]);
    }
  }
}

TEST(PhaseValues, HenyeyGreensteinHasItsMoments) {
  for (const double g : {-0.9, -0.2, 0.0, 0.4, 0.9}) {
    const auto phase = make("hg", "<float name=\"g\" value=\"" + std::to_string(g) + "\"/>");
    EXPECT_NEAR(mean_cosine(*phase), g, 2e-5);
    // Of Legendre's polynomials: g^l.
    EXPECT_NEAR(moment(*phase, [](double mu) { return 1.5 * mu * mu - 0.5; }), g * g, 2e-5);
  }
}

TEST(PhaseValues, NarrowPeaksKeepTheirDigits) {
  // p(theta)/p(0) = (1 + (theta/(1 - g))^2 g)^(-3/2) where theta is small.
  constexpr double kG = 0.99999, kGap = 1 - kG;
  const auto forward = make("hg", R"(<float name="g" value="0.99999"/>)");
  const auto backward = make("hg", R"(<float name="g" value="-0.99999"/>)");
  const Vec3 wi = direction(0.9, 2.1), axis = direction(0.9 + M_PI / 2, 2.1);
  for (const double theta : {1e-5, 5e-5, 2e-4}) {
    const double expected = std::pow(1 + kG * theta * theta / (kGap * kGap), -1.5);
    const Vec3 turned = normalize(-wi + float(theta) * axis);
    EXPECT_NEAR(value(*forward, wi, turned) / value(*forward, wi, -wi) / expected, 1, 0.02) << theta;
    EXPECT_NEAR(value(*backward, wi, -turned) / value(*backward, wi, wi) / expected, 1, 0.02) << theta;
  }
}

TEST(PhaseValues, DoubleHenyeyGreensteinIsASum) {
  const auto phase = make("double_hg", R"(<float name="g_forward" value="0.85"/>
      <float name="g_backward" value="-0.4"/><float name="weight" value="0.7"/>)");
  EXPECT_NEAR(moment(*phase, [](double) { return 1; }), 1, 1e-5);
  EXPECT_NEAR(mean_cosine(*phase), 0.7 * 0.85 - 0.3 * 0.4, 2e-5);
  EXPECT_NEAR(moment(*phase, [](double mu) { return 1.5 * mu * mu - 0.5; }), 0.7 * 0.85 * 0.85 + 0.3 * 0.16,
              2e-5);
}

TEST(PhaseValues, RayleighDepolarised) {
  // Chandrasekhar: 3/(4 (1 + 2 gamma)) ((1 + 3 gamma) + (1 - gamma) mu^2) over 4 pi; at 90 degrees the weaker
  // polarisation has rho of the stronger, so that p(0)/p(90 degrees) = 2/(1 + rho).
  for (const double rho : {0.0, 0.028, 0.5, 1.0}) {
    const auto phase =
        make("rayleigh", "<float name=\"depolarization\" value=\"" + std::to_string(rho) + "\"/>");
    EXPECT_NEAR(moment(*phase, [](double) { return 1; }), 1, 1e-5);
    EXPECT_NEAR(value(*phase, 1) / value(*phase, 0), 2 / (1 + rho), 1e-5);
    EXPECT_NEAR(value(*phase, 0.5) - value(*phase, 0), (value(*phase, 1) - value(*phase, 0)) / 4, 1e-6);
    EXPECT_NEAR(value(*phase, -0.5), value(*phase, 0.5), 1e-6);
  }
}

TEST(PhaseValues, TablesAreLinearBetweenTheirNumbers) {
  const auto phase = make("tabphase", R"(<string name="values" value="2, 0, 1, 5"/>)");
  // Trapezoids of width 2/3.
  const double integral = 2 * M_PI * (2.0 / 3) * (1 + 0 + 1 + 2.5);
  EXPECT_NEAR(value(*phase, -1), 2 / integral, 1e-5);
  EXPECT_NEAR(value(*phase, -2.0 / 3), 1 / integral, 1e-5);
  EXPECT_NEAR(value(*phase, 0), 0.5 / integral, 1e-5);
  EXPECT_NEAR(value(*phase, 0.1), (0.5 + 0.1 * 1.5) / integral, 1e-5);
  EXPECT_NEAR(value(*phase, 0.9), (1 + 4 * (0.9 - 1.0 / 3) * 1.5) / integral, 1e-5);
  EXPECT_NEAR(value(*phase, 1), 5 / integral, 1e-5);
}

TEST(PhaseValues, BlendsAreLinear) {
  const std::string a = R"(<phase type="hg"><float name="g" value="0.7"/></phase>)",
                    b = R"(<phase type="rayleigh"/>)";
  const auto first = build<PhaseFunction>(a), second = build<PhaseFunction>(b);
  for (const double w : {0.0, 0.25, 1.0}) {
    const auto phase =
        make("blendphase", "<float name=\"weight\" value=\"" + std::to_string(w) + "\"/>" + a + b);
    for (const double mu : {-0.8, 0.1, 0.95})
      EXPECT_NEAR(value(*phase, mu), (1 - w) * value(*first, mu) + w * value(*second, mu), 1e-6);
  }
}

TEST(PhaseValues, BlendsWeightByArea) {
  const auto flakes = make("sggx", R"(<string name="S" value="0.04, 0.04, 1, 0, 0, 0"/>)");
  const auto phase = make("blendphase", R"(<float name="weight" value="0.5"/><phase type="isotropic"/>
      <phase type="sggx"><string name="S" value="0.04, 0.04, 1, 0, 0, 0"/></phase>)");
  EXPECT_FALSE(phase->is_isotropic_medium());
  EXPECT_NEAR(phase->projected_area({1, 0, 0}, {}), 0.5 * (1 + 0.2), 1e-6);
  const Vec3 wi{1, 0, 0}, wo = direction(1.1, 0.3);
  EXPECT_NEAR(value(*phase, wi, wo), (1 / (4 * M_PI) + 0.2 * value(*flakes, wi, wo)) / 1.2, 1e-6);
}

TEST(PhaseValues, FlakesShowTheirArea) {
  const auto phase = make("sggx", R"(<string name="S" value="0.5, 0.9, 0.2, 0.1, -0.15, 0.05"/>)");
  // phase.projected_area of Mitsuba 3.9.1.
  EXPECT_NEAR(phase->projected_area(direction(0.3, 0.2), {}), 0.3918929697, 1e-6);
  EXPECT_NEAR(phase->projected_area(direction(1.2, 0.2), {}), 0.6446412802, 1e-6);
  EXPECT_NEAR(phase->projected_area(direction(2.0, 1.0), {}), 0.8870757818, 1e-6);
  double most = 0;
  for (int i = 0; i < 500; ++i)
    most = std::max(most, double(phase->projected_area(direction(0.01 * i, 0.37 * i), {})));
  EXPECT_GE(phase->largest_projected_area(), most);
  EXPECT_LE(phase->largest_projected_area(), 1.2 * most);
}

TEST(PhaseValues, FlakesOfASphereScatterAlike) {
  // Mirrors with the normals of a sphere: each direction is as likely as any other.
  const auto phase = make("sggx", R"(<string name="S" value="4, 4, 4, 0, 0, 0"/>)");
  for (int i = 1; i < 20; ++i)
    EXPECT_NEAR(value(*phase, direction(0.1, 0), direction(0.15 * i, i)), 1 / (4 * M_PI), 1e-6);
  EXPECT_NEAR(phase->projected_area(direction(1, 2), {}), 2, 1e-6);
}

TEST(PhaseValues, FlatFlakesAreAMirror) {
  // All normals near z: light leaves where a mirror would send it.
  const auto phase = make("sggx", R"(<string name="S" value="1e-4, 1e-4, 1, 0, 0, 0"/>)");
  const Vec3 wi = direction(0.6, 0.3);
  int near = 0;
  constexpr int kSamples = 400;
  for (int i = 0; i < kSamples; ++i) {
    const auto s =
        phase->sample(wi, 0.5f, {float(i + 0.5) / kSamples, std::fmod(0.618f * float(i), 1.f)}, kContext);
    ASSERT_TRUE(s);
    near += dot(s->wo, {-wi.x, -wi.y, wi.z}) > std::cos(0.1f);
  }
  EXPECT_GT(near, kSamples * 9 / 10);
  EXPECT_NEAR(phase->projected_area({0, 0, 1}, {}), 1, 1e-6);
  EXPECT_NEAR(phase->projected_area({1, 0, 0}, {}), 0.01, 1e-6);
}

void expect_error(const std::string& type, const std::string& parameters, const std::string& text) {
  try {
    make(type, parameters);
    ADD_FAILURE() << type << " took " << parameters;
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find(text), std::string::npos) << e.what();
  }
}

TEST(PhaseValues, RefuseWrongInput) {
  expect_error("hg", R"(<float name="g" value="1"/>)", "between -1 and 1");
  expect_error("double_hg", R"(<float name="g_backward" value="-1"/>)", "between -1 and 1");
  expect_error("double_hg", R"(<float name="weight" value="1.5"/>)", "in [0, 1]");
  expect_error("rayleigh", R"(<float name="depolarization" value="-0.1"/>)", "in [0, 1]");
  expect_error("tabphase", "", "values");
  expect_error("tabphase", R"(<string name="values" value="1"/>)", "at least two");
  expect_error("tabphase", R"(<string name="values" value="1, -1"/>)", "negative");
  expect_error("tabphase", R"(<string name="values" value="0, 0"/>)", "all numbers are zero");
  expect_error("tabphase", R"(<string name="values" value="1, two"/>)", "not a number");
  expect_error("blendphase", R"(<phase type="hg"/><phase type="hg"/>)", "\"weight\" is required");
  expect_error("blendphase", R"(<float name="weight" value="0.5"/><phase type="hg"/>)", "got 1");
  expect_error("blendphase", R"(<float name="weight" value="2"/><phase type="hg"/><phase type="hg"/>)",
               "[0, 1]");
  expect_error("sggx", "", "\"S\" is required");
  expect_error("sggx", R"(<string name="S" value="1, 1, 1"/>)", "six numbers");
  expect_error("sggx", R"(<string name="S" value="1, 1, 1, 2, 0, 0"/>)", "positive definite");
  expect_error("sggx", R"(<string name="S" value="1, 1, 0, 0, 0, 0"/>)", "positive definite");
}

}  // namespace
}  // namespace aureole
