// SPDX-License-Identifier: Apache-2.0
// Goniometers: readings against closed forms, tables that are materials again, and models fitted to them.
#include "aureole/instrument/laboratory/goniometer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "aureole/bsdf/measured/scattered_table.h"
#include "aureole/core/error.h"
#include "aureole/instrument/laboratory/brdf_fit.h"
#include "aureole/instrument/laboratory/lateral_spread.h"
#include "aureole/math/vec.h"
#include "harness/properties_builder.h"

namespace aureole::testing {
namespace {

Bench bench_of(std::int64_t paths, int replicates = 8, std::uint64_t seed = 0,
               std::vector<double> nm = {550}) {
  TraceSettings trace;
  trace.paths = paths, trace.replicates = replicates, trace.seed = seed, trace.threads = 2;
  return {SpectralGrid::over(360, 830), 1, {std::move(nm), 10}, trace};
}
Specimen material(const std::string& xml) {
  Specimen s{.name = "sample"};
  s.bsdf = build<Bsdf>(xml);
  return s;
}
std::string message_of(const std::function<void()>& f) {
  try {
    f();
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}
GonioPlan plan_of(GonioPlan::Kind kind, std::vector<double> incident, int directions) {
  GonioPlan plan;
  plan.kind = kind, plan.incident = std::move(incident), plan.directions = directions;
  return plan;
}

TEST(Goniometer, LambertianSampleReadsReflectanceOverPi) {
  for (const bool by_reference : {false, true}) {
    GoniometerSettings s;
    s.by_reference = by_reference;
    const GonioTable t = measure_scattering(bench_of(1024), lambertian_standard(0.5), s,
                                            plan_of(GonioPlan::Kind::hemispherical, {0, 40, 80}, 30));
    EXPECT_GE(t.readings.size(), 45u);
    for (const GonioReading& r : t.readings)
      EXPECT_NEAR(r.f[0], 0.5 / M_PI, 4.5 * r.error[0] + 1e-3 * 0.5 / M_PI)
          << by_reference << ", " << r.theta_i << ", " << r.theta_o << ", " << r.phi_o;
  }
}

// Equation 37 of a mirror: all of its light falls into the aperture, F/(Omega cos theta).
TEST(Goniometer, MirrorReadsItsReflectanceOverTheProjectedSolidAngle) {
  GoniometerSettings s;
  s.lamp_angle = 0.6, s.detector_angle = 1.5, s.viewed_m = 1e-3, s.lit_m = 4e-3;
  for (const double angle : {20.0, 60.0}) {
    GonioPlan plan = plan_of(GonioPlan::Kind::in_plane, {angle}, 35);  // steps of 5 degrees
    const GonioTable t = measure_scattering(
        bench_of(1 << 15),
        material("<bsdf type=\"conductor\"><string name=\"material\" value=\"none\"/></bsdf>"), s, plan);
    const double omega = M_PI * std::pow(std::tan(1.5 * M_PI / 180), 2);
    bool is_found = false;
    for (const GonioReading& r : t.readings) {
      const bool is_mirrored = std::abs(r.theta_o - angle) < 0.01 && std::abs(r.phi_o - 180) < 0.01;
      is_found |= is_mirrored;
      const double expected = is_mirrored ? 1 / (omega * std::cos(angle * M_PI / 180)) : 0;
      EXPECT_NEAR(r.f[0], expected, 4.5 * r.error[0] + 0.01 * expected) << angle << ", " << r.theta_o;
      if (is_mirrored) {
        EXPECT_LT(r.error[0], 0.02 * expected);
      }
    }
    EXPECT_TRUE(is_found) << angle;
  }
}

TEST(Goniometer, ReflectancesOfASmoothSurfaceAreFresnels) {
  // A smooth interface of index 1.5 over black.
  const ReflectanceReport r = report_reflectances(bench_of(1 << 15), black_glass(1.5), {});
  EXPECT_NEAR(r.angles[0].hd.value, 0.04, 2e-4);
  EXPECT_NEAR(r.hh.value, 0.09178, 4.5 * r.hh.error + 2e-4);
  EXPECT_LT(r.hh.error, 1e-3);
  // Light of a lamp, which the receiver finds by chance.
  EXPECT_NEAR(r.angles[0].dh.value, 0.04, 4.5 * r.angles[0].dh.error);
  EXPECT_LT(r.angles[0].dh.error, 0.004);
  EXPECT_TRUE(r.is_isotropic);
  EXPECT_NE(report_text(r).find("no more light is scattered than arrives"), std::string::npos);
}

// Equation 30 of a smooth surface: light of a stated radiance is reflected by the mean of Fresnel's reflectance that this light weighs.
TEST(Goniometer, ReflectanceOfStatedLightIsFresnelsWeightedMean) {
  const Specimen glass = black_glass(1.5);
  const auto fresnel = [](double cosine) {
    const double t = std::sqrt(1 - (1 - cosine * cosine) / 2.25);
    const double s = (cosine - 1.5 * t) / (cosine + 1.5 * t), p = (t - 1.5 * cosine) / (t + 1.5 * cosine);
    return 0.5 * (s * s + p * p);
  };
  // Radiance 1 at the zenith that falls linearly to 0 at 60 degrees, and light from the horizon alone.
  const std::vector<std::pair<std::string, std::function<double(double)>>> lights{
      {"0:1, 60:0, 90:0", [](double a) { return std::max(0.0, 1 - a / 60); }},
      {"0:0,50:0,90:2", [](double a) { return std::max(0.0, (a - 50) / 20); }},
      {"0:1,90:1", [](double) { return 1.0; }}};
  for (const auto& [text, radiance] : lights) {
    double reflected = 0, arriving = 0;
    for (int k = 0; k < 90000; ++k) {
      const double angle = (k + 0.5) * 1e-3 * M_PI / 180;
      const double flux = radiance((k + 0.5) * 1e-3) * std::cos(angle) * std::sin(angle);
      reflected += fresnel(std::cos(angle)) * flux, arriving += flux;
    }
    const ReflectanceReport r = report_reflectances(bench_of(1 << 15), glass, {}, {text, {}});
    const double expected = reflected / arriving;
    EXPECT_NEAR(r.of_light->value, expected, 4.5 * r.of_light->error + 4e-3 * expected) << text;
    EXPECT_LT(r.of_light->error, 0.02 * expected) << text;
  }
  EXPECT_NE(message_of([&] {
              report_reflectances(bench_of(64), glass, {}, {"0:1,95:2", {}});
            }).find("0 to 90 degrees"),
            std::string::npos);
  EXPECT_NE(message_of([&] {
              report_reflectances(bench_of(64), glass, {}, {"0:1,30", {}});
            }).find("are expected"),
            std::string::npos);
  EXPECT_NE(message_of([&] {
              report_reflectances(bench_of(64), glass, {}, {"no_map.exr", {}});
            }).find("no_map.exr"),
            std::string::npos);
}

TEST(Goniometer, ReflectanceFromConeToCone) {
  GoniometerSettings s;
  s.viewed_m = 0.2e-3, s.lit_m = 2e-3;
  // A perfect diffuser of 0.5 sends sin^2(half) cos(theta) of its light into a cone.
  const ReflectanceReport even = report_reflectances(bench_of(1 << 13), lambertian_standard(0.5), s,
                                                     {"", {{30, 5, 40, 8}, {0, 10, 60, 15}}});
  ASSERT_EQ(even.cones.size(), 2u);
  const double expected[2] = {std::pow(std::sin(8 * kDegree), 2) * std::cos(40 * kDegree),
                              std::pow(std::sin(15 * kDegree), 2) * std::cos(60 * kDegree)};
  for (int k = 0; k < 2; ++k) {
    EXPECT_NEAR(even.cones[std::size_t(k)].reflectance.value, 0.5 * expected[k], 4e-3 * expected[k]) << k;
    EXPECT_NEAR(even.cones[std::size_t(k)].factor, 0.5, 3e-3) << k;
  }
  // All of a mirror's light is within a cone that is wider than the incident one; nothing is in another cone.
  Specimen mirror{
      .name = "mirror",
      .element =
          "<bsdf type=\"roughconductor\"><string name=\"material\" value=\"none\"/><float name=\"alpha\" "
          "value=\"0.0005\"/></bsdf>"};
  const ReflectanceReport narrow =
      report_reflectances(bench_of(1 << 14), mirror, s, {"", {{45, 2, 45, 4}, {45, 2, 30, 4}}});
  EXPECT_NEAR(narrow.cones[0].reflectance.value, 1, 0.02);
  EXPECT_NEAR(narrow.cones[1].reflectance.value, 0, 1e-3);
  EXPECT_NE(message_of([&] {
              report_reflectances(bench_of(64), mirror, s, {"", {{80, 10, 0, 5}}});
            }).find("--cones"),
            std::string::npos);
}

// With wrong angles readings are off as the uncertainties say, on the slopes of a lobe and at its peak.
TEST(Goniometer, UncertaintiesHoldTheErrorOfTheAngles) {
  const Specimen metal = material(
      R"(<bsdf type="roughconductor"><string name="material" value="none"/><float name="alpha" value="0.15"/></bsdf>)");
  GoniometerSettings s;
  const GonioPlan plan = plan_of(GonioPlan::Kind::in_plane, {30}, 35);
  const GonioTable exact = measure_scattering(bench_of(1 << 12), metal, s, plan);
  s.angle_error = 0.4;
  double z2 = 0, weight = 0;
  constexpr int kSeeds = 12;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const GonioTable t = measure_scattering(bench_of(1 << 10, 8, std::uint64_t(seed)), metal, s, plan);
    for (std::size_t k = 0; k < t.readings.size(); ++k) {
      if (exact.readings[k].f[0] < 0.02) continue;
      const double z = (t.readings[k].f[0] - exact.readings[k].f[0]) /
                       std::hypot(t.readings[k].error[0], exact.readings[k].error[0]);
      z2 += z * z, weight += 1;
    }
  }
  EXPECT_GT(weight, 100);
  // All detectors of a run share the lamp's error, so that some 12 of these differences are independent.
  EXPECT_GT(z2 / weight, 0.4);
  EXPECT_LT(z2 / weight, 2.2);
}

// Spread of a slab: what leaves everywhere adds up to its reflectance, and far from the spot diffusion holds.
TEST(LateralSpread, PointAndLineSpreadOfASlab) {
  Specimen slab{.name = "slab", .thickness_m = 20e-3};
  slab.bsdf = build<Bsdf>(R"(<bsdf type="null"/>)");
  slab.medium = build<Medium>(
      R"(<medium type="homogeneous"><float name="sigma_t" value="1000"/><float name="albedo" value="0.99"/></medium>)");
  SpreadSettings s;
  s.sample_m = 100e-3, s.lit_m = 0.5e-3, s.receiver_m = 1e-3;
  s.at_m = {2e-3, 4e-3, 8e-3};
  for (const bool is_line : {false, true}) {
    s.is_line = is_line;
    const SpreadTable t = measure_spread(bench_of(1 << 14, 16), slab, s);
    ASSERT_EQ(t.readings.size(), 3u);
    for (const SpreadReading& r : t.readings) {
      EXPECT_GT(r.values[0].value, 0);
      const double relative = r.values[0].error / r.values[0].value;
      EXPECT_LT(relative, 0.3) << r.at_m;
      // Diffusion is good to some 10 % a few transport lengths (1 mm) from the spot, and off by 25 % at two of them.
      EXPECT_NEAR(r.predicted.at(0) / r.values[0].value, 1, (r.at_m < 3e-3 ? 0.3 : 0.15) + 4 * relative)
          << is_line << " " << r.at_m;
    }
    EXPECT_NE(spread_table_content(t).find(is_line ? "1/m;" : "1/m^2;"), std::string::npos);
  }
  EXPECT_NE(message_of([&] { measure_spread(bench_of(64), lambertian_standard(0.5), s); }).find("is no slab"),
            std::string::npos);
  s.at_m = {2e-3, 1e-3};
  EXPECT_NE(message_of([&] { measure_spread(bench_of(64), slab, s); }).find("must increase"),
            std::string::npos);
  s.at_m = {70e-3};
  EXPECT_NE(message_of([&] { measure_spread(bench_of(64), slab, s); }).find("is not over the sample"),
            std::string::npos);
}

TEST(LateralSpread, LightPassesASmoothInterface) {
  Specimen slab{.name = "slab", .thickness_m = 3e-3};
  slab.bsdf = build<Bsdf>(
      R"(<bsdf type="dielectric"><float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/></bsdf>)");
  slab.medium = build<Medium>(
      R"(<medium type="homogeneous"><float name="sigma_t" value="2000"/><float name="albedo" value="0.999"/></medium>)");
  SpreadSettings s;
  s.at_m = {1.5e-3, 3e-3};
  const SpreadTable t = measure_spread(bench_of(1 << 12, 16), slab, s);
  ASSERT_EQ(t.readings.size(), 2u);
  for (const SpreadReading& r : t.readings) {
    EXPECT_GT(r.values[0].value, 0);
    const double relative = r.values[0].error / r.values[0].value;
    EXPECT_LT(relative, 0.25) << r.at_m;
    // Three and six transport lengths (0.5 mm) from the spot diffusion is some 20 % off.
    EXPECT_NEAR(r.predicted.at(0) / r.values[0].value, 1, 0.3 + 4 * relative) << r.at_m;
  }
}

TEST(Goniometer, ReportFindsAnisotropyAndReciprocity) {
  const ReflectanceReport r = report_reflectances(
      bench_of(1 << 13),
      material(
          "<bsdf type=\"ward\"><float name=\"alpha_u\" value=\"0.5\"/><float name=\"alpha_v\" value=\"0.15\"/></bsdf>"),
      {});
  EXPECT_FALSE(r.is_isotropic);
  EXPECT_GT(r.anisotropy, 0.1);
  for (const auto& p : r.pairs)
    EXPECT_NEAR(p.forward.value, p.backward.value,
                4.5 * std::hypot(p.forward.error, p.backward.error) + 3e-3 * p.forward.value);
  for (const auto& a : r.angles)
    EXPECT_NEAR(a.dh.value, a.hd.value, 4.5 * std::hypot(a.dh.error, a.hd.error) + 3e-3);
}

TEST(Goniometer, AdaptivePlansLookWhereTheLobeIs) {
  const Specimen metal = material(
      R"(<bsdf type="roughconductor"><string name="material" value="none"/><string name="distribution" value="ggx"/><float name="alpha" value="0.1"/></bsdf>)");
  const auto near_lobe = [&](GonioPlan::Kind kind) {
    const GonioTable t = measure_scattering(bench_of(256), metal, {}, plan_of(kind, {40}, 150));
    int count = 0;
    for (const GonioReading& r : t.readings) {
      const double ct = std::cos(r.theta_o * kDegree) * std::cos(40 * kDegree) -
                        std::sin(r.theta_o * kDegree) * std::sin(40 * kDegree) * std::cos(r.phi_o * kDegree);
      count += ct > std::cos(15 * kDegree);
    }
    return std::pair(count, t.readings.size());
  };
  const auto [even, all_even] = near_lobe(GonioPlan::Kind::hemispherical);
  const auto [adapted, all_adapted] = near_lobe(GonioPlan::Kind::adaptive);
  EXPECT_GT(adapted, 2 * even);
  EXPECT_LE(all_adapted, 151u);
}

TEST(Goniometer, DirectionsOfPlansCoverTheirSides) {
  for (const int count : {8, 100, 1000}) {
    const auto all = outgoing_directions(GonioPlan::Kind::hemispherical, count);
    EXPECT_LE(all.size(), std::size_t(count));
    EXPECT_GE(all.size(), std::size_t(count) / 2);
  }
  const auto plane = outgoing_directions(GonioPlan::Kind::in_plane, 35);
  EXPECT_EQ(plane.size(), 35u);
  EXPECT_EQ(plane.front()[0], 85);
  EXPECT_EQ(plane.front()[1], 180);
}

TEST(Goniometer, TableIsTheMaterialAgain) {
  const Specimen paint = material(
      R"(<bsdf type="roughplastic"><float name="alpha" value="0.3"/><float name="diffuse_reflectance" value="0.4"/></bsdf>)");
  const GonioTable t =
      measure_scattering(bench_of(256, 8, 0, {450, 550, 650}), paint, {},
                         plan_of(GonioPlan::Kind::hemispherical, {0, 10, 20, 30, 40, 50, 60, 70}, 900));
  const std::string path = ::testing::TempDir() + "goniometer.csv";
  std::ofstream(path) << gonio_table_content(t);
  const ScatteredMeasurements read = read_scattered_measurements(path, false);
  EXPECT_EQ(read.nm, t.nm);
  EXPECT_EQ(read.errors.size(), read.values.size());
  EXPECT_EQ(read.directions.size(), t.readings.size());
  const auto copy =
      build<Bsdf>("<bsdf type=\"tabulated\"><string name=\"filename\" value=\"" + path + "\"/></bsdf>");
  const auto mean_difference = [&] {
    Specimen loop{.name = "loop"};
    loop.bsdf = copy;
    const auto in_plane = plan_of(GonioPlan::Kind::in_plane, {25}, 31);
    const GonioTable a = measure_scattering(bench_of(1024), paint, {}, in_plane),
                     b = measure_scattering(bench_of(1024), loop, {}, in_plane);
    double difference = 0, sum = 0;
    for (std::size_t k = 0; k < a.readings.size(); ++k)
      difference += std::abs(a.readings[k].f[0] - b.readings[k].f[0]), sum += a.readings[k].f[0];
    return difference / sum;
  };
  EXPECT_LT(mean_difference(), 0.04);
}

/// The fit of one model.
BrdfFit fit_of(const std::vector<BrdfFit>& fits, const std::string& model) {
  for (const BrdfFit& f : fits)
    if (f.model == model) return f;
  ADD_FAILURE() << model;
  return {};
}

// Each analytic material is measured with noise; its own model wins and its intervals hold the parameters.
TEST(BrdfFits, TrueModelWinsAndItsIntervalsHoldTheParameters) {
  struct Case {
    std::string model, xml;
    std::vector<std::pair<std::string, double>> truth;
  };
  const std::vector<Case> cases{
      {"lambert", "<bsdf type=\"diffuse\"><float name=\"reflectance\" value=\"0.4\"/></bsdf>", {{"kd", 0.4}}},
      {"oren_nayar",
       "<bsdf type=\"oren_nayar\"><float name=\"reflectance\" value=\"0.6\"/><float name=\"sigma\" value=\"25\"/></bsdf>",
       {{"reflectance", 0.6}, {"sigma", 25}}},
      {"ward",
       "<bsdf type=\"ward\"><float name=\"alpha_u\" value=\"0.25\"/><float name=\"alpha_v\" value=\"0.25\"/><float name=\"specular_reflectance\" value=\"0.2\"/><float name=\"diffuse_reflectance\" value=\"0.3\"/></bsdf>",
       {{"alpha", 0.25}, {"ks", 0.2}, {"kd", 0.3}}},
      {"beckmann",
       "<bsdf type=\"roughconductor\"><string name=\"material\" value=\"none\"/><float name=\"specular_reflectance\" value=\"0.7\"/><float name=\"alpha\" value=\"0.3\"/></bsdf>",
       {{"alpha", 0.3}, {"ks", 0.7}}},
      {"ggx",
       "<bsdf type=\"roughconductor\"><string name=\"material\" value=\"none\"/><string name=\"distribution\" value=\"ggx\"/><float name=\"specular_reflectance\" value=\"0.7\"/><float name=\"alpha\" value=\"0.2\"/></bsdf>",
       {{"alpha", 0.2}, {"ks", 0.7}}},
      {"cook_torrance",
       "<bsdf type=\"cook_torrance\"><float name=\"alpha\" value=\"0.3\"/><float name=\"eta\" value=\"1.6\"/><float name=\"specular\" value=\"1\"/><float name=\"diffuse\" value=\"0\"/></bsdf>",
       {{"alpha", 0.3}, {"eta", 1.6}}},
      {"principled",
       "<bsdf type=\"principled\"><float name=\"base_color\" value=\"0.5\"/><float name=\"roughness\" value=\"0.5\"/><float name=\"metallic\" value=\"0.4\"/><float name=\"specular\" value=\"0.6\"/></bsdf>",
       {{"base_color", 0.5}, {"roughness", 0.5}, {"metallic", 0.4}}}};
  int covered = 0, all = 0;
  for (const Case& c : cases) {
    GoniometerSettings s;
    s.noise = 0.01;
    GonioPlan plan = plan_of(GonioPlan::Kind::hemispherical, {10, 30, 50, 70}, 120);
    const GonioTable t = measure_scattering(bench_of(512), material(c.xml), s, plan);
    FitSettings f;
    f.lamp_angle = s.lamp_angle, f.detector_angle = s.detector_angle, f.floor = 1e-3;
    f.viewed_m = s.viewed_m, f.distance_m = s.distance_m;
    const std::vector<BrdfFit> fits = fit_brdfs(t, f);
    const BrdfFit own = fit_of(fits, c.model);
    EXPECT_LT(own.chi_squared / double(own.readings), 1.35) << c.model;
    // Readings far below the peak have the floor for their uncertainty.
    EXPECT_GT(own.chi_squared / double(own.readings), 0.35) << c.model;
    // A model that contains another one is as good, but for its number of parameters.
    EXPECT_LT(own.aic, fits[0].aic + 8) << c.model << " lost to " << fits[0].model;
    if (c.model != "lambert") {
      EXPECT_GT(fit_of(fits, "lambert").aic, own.aic + 100) << c.model;
    }
    for (const auto& [name, truth] : c.truth)
      for (const FittedParameter& p : own.parameters)
        if (p.name == name) {
          EXPECT_NEAR(p.value, truth, 3 * 0.51 * (p.high - p.low) + 1e-3 * truth) << c.model << " " << name;
          EXPECT_LT(p.high - p.low, 0.5 * truth) << c.model << " " << name;
          ++all, covered += p.low <= truth && truth <= p.high;
        }
    // The fitted element is a material.
    if (own.bsdf.find("<!--") == std::string::npos) {
      EXPECT_NO_THROW(build<Bsdf>(own.bsdf)) << own.bsdf;
    }
  }
  // Intervals of 95 %: of 16 parameters at least 12, but for a chance of 1e-3.
  EXPECT_GE(covered, all - 4) << covered << " of " << all;
}

// At grazing incidence directions differ over the viewed area by as much as within the cones: fits average over both.
TEST(BrdfFits, GrazingReadingsDoNotBiasTheFit) {
  for (const double alpha : {0.1, 0.2}) {
    GoniometerSettings s;
    s.noise = 0.003;
    const GonioTable t = measure_scattering(
        bench_of(2048),
        material(
            "<bsdf type=\"roughconductor\"><string name=\"material\" value=\"none\"/><string name=\"distribution\" "
            "value=\"ggx\"/><float name=\"specular_reflectance\" value=\"0.7\"/><float name=\"alpha\" value=\"" +
            std::to_string(alpha) + "\"/></bsdf>"),
        s, plan_of(GonioPlan::Kind::hemispherical, {0, 20, 40, 55, 68, 77, 83, 87}, 240));
    FitSettings f;
    f.models = {"ggx"}, f.lamp_angle = s.lamp_angle, f.detector_angle = s.detector_angle;
    const double biased = fit_of(fit_brdfs(t, f), "ggx").parameters.back().value;
    f.viewed_m = s.viewed_m, f.distance_m = s.distance_m;
    FitSettings impossible = f;
    for (const double angle : {-1.0, 60.0, std::numeric_limits<double>::quiet_NaN()}) {
      impossible.detector_angle = angle;
      EXPECT_THROW(fit_brdfs(t, impossible), Error) << angle;
    }
    impossible = f;
    impossible.viewed_m = 2 * f.distance_m;
    EXPECT_THROW(fit_brdfs(t, impossible), Error);
    const BrdfFit fit = fit_of(fit_brdfs(t, f), "ggx");
    const FittedParameter& p = fit.parameters.back();
    ASSERT_EQ(p.name, "alpha");
    EXPECT_NEAR(p.value, alpha, 3 * 0.51 * (p.high - p.low)) << alpha;
    EXPECT_LT(p.high - p.low, 0.01 * alpha) << alpha;
    EXPECT_GT(std::abs(biased - alpha), 2 * std::abs(p.value - alpha)) << alpha;
    EXPECT_LT(fit.chi_squared / double(fit.readings), 1.5) << alpha;
  }
}

TEST(BrdfFits, BeckmannAndGgxAreToldApart) {
  for (const std::string name : {"beckmann", "ggx"}) {
    const GonioTable t = measure_scattering(
        bench_of(512),
        material(
            "<bsdf type=\"roughconductor\"><string name=\"material\" value=\"none\"/><string name=\"distribution\" value=\"" +
            name + "\"/><float name=\"alpha\" value=\"0.25\"/></bsdf>"),
        {}, plan_of(GonioPlan::Kind::hemispherical, {20, 60}, 150));
    const std::vector<BrdfFit> fits =
        fit_brdfs(t, {.models = {"beckmann", "ggx"}, .lamp_angle = 0.5, .detector_angle = 0.5});
    EXPECT_EQ(fits[0].model, name);
    EXPECT_GT(fits[1].aic, fits[0].aic + 50);
  }
}

TEST(Goniometer, BadInputIsAnErrorThatSaysWhatIsExpected) {
  const Specimen white = lambertian_standard(0.5);
  const auto fails = [&](auto change, const std::string& expected) {
    GoniometerSettings s;
    GonioPlan plan = plan_of(GonioPlan::Kind::in_plane, {30}, 5);
    change(s, plan);
    const std::string message = message_of([&] { measure_scattering(bench_of(256), white, s, plan); });
    EXPECT_NE(message.find(expected), std::string::npos) << message;
  };
  fails([](auto& s, auto&) { s.sample_m = 5e-3; }, "the sample of 5 mm is smaller than the spot of 20 mm");
  fails([](auto& s, auto&) { s.lamp_angle = NAN; }, "a lamp's half-angle in degrees of nan");
  fails([](auto&, auto& p) { p.incident = {95}; }, "an angle of incidence of 95 degrees");
  fails([](auto&, auto& p) { p.directions = 0; }, "0 directions");
  fails([](auto&, auto& p) { p.azimuths = {400}; }, "an azimuth of 400");
  EXPECT_NE(message_of([] {
              fit_brdfs({{550}, {}, {}}, {.models = {"gxg"}});
            }).find("did you mean"),
            std::string::npos);
  EXPECT_NE(message_of([] {
              fit_brdfs({{550}, {}, {}}, {});
            }).find("there is no reading"),
            std::string::npos);
  const std::string path = ::testing::TempDir() + "bad_uncertainty.csv";
  std::ofstream(path) << "theta_i,theta_o,550nm,u(550nm)\n0,10,0.1,-1\n";
  EXPECT_NE(message_of([&] {
              read_scattered_measurements(path, false);
            }).find("a standard uncertainty is positive"),
            std::string::npos);
  std::ofstream(path) << "theta_i,theta_o,550nm,u(560nm)\n0,10,0.1,1\n";
  EXPECT_NE(message_of([&] { read_scattered_measurements(path, false); }).find("columns of uncertainties"),
            std::string::npos);
}

}  // namespace
}  // namespace aureole::testing
