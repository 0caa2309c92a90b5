// SPDX-License-Identifier: Apache-2.0
// Spectrophotometers: traced instruments against closed forms of what they measure.
#include "aureole/instrument/laboratory/spectrophotometer.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "aureole/core/error.h"
#include "aureole/instrument/laboratory/spectrum_files.h"
#include "aureole/instrument/paint/paint_files.h"
#include "aureole/math/warp.h"
#include "aureole/plugin/registry.h"
#include "harness/effort.h"
#include "harness/properties_builder.h"

namespace aureole::testing {
namespace {

using Method = SpectrophotometerSettings::Method;

/// A sheet that scatters light by angles of a Gaussian distribution, `sigma` degrees along each axis, and loses none.
class GaussianSheet final : public Bsdf {
public:
  explicit GaussianSheet(const Properties& p) : Bsdf(p), sigma_(p.get_float("sigma", 1) * kDegree) {}
  BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext&) const override {
    const double sine = double(length(cross(wi, wo))), angle = std::atan2(sine, -double(dot(wi, wo)));
    if (!(wi.z * wo.z < 0)) return {};
    const double q = angle / sigma_;
    const double density =
        std::exp(-0.5 * q * q) / (2 * M_PI * sigma_ * sigma_) * (angle > 1e-6 ? angle / sine : 1);
    return {float(density), float(density)};
  }
  std::optional<BsdfSample> sample(const Vec3& wi, float, Vec2 u, const BsdfContext& ctx) const override {
    const double angle = sigma_ * std::sqrt(-2 * std::log1p(-double(u.x))), phi = 2 * M_PI * double(u.y);
    const Vec3 wo =
        Frame::from_normal(-wi).to_world({float(std::sin(angle) * std::cos(phi)),
                                          float(std::sin(angle) * std::sin(phi)), float(std::cos(angle))});
    const BsdfEval e = eval_pdf(wi, wo, ctx);
    if (!(e.pdf[0] > 0)) return {};
    std::optional<BsdfSample> s;
    s.emplace();
    s->wo = wo, s->value = e.value, s->pdf = e.pdf, s->lobe = lobes();
    return s;
  }
  Lobe lobes() const override { return Lobe::glossy | Lobe::transmit; }

private:
  double sigma_;
};
// Its documentation has no example: all examples are tested as materials, which this one is not (it is not reciprocal).
AUREOLE_PLUGIN(GaussianSheet, "bsdf", "test_gaussian_sheet",
               PluginDoc{"A sheet that blurs what is behind it.",
                         "",
                         {{"sigma", "float", "degrees", "1", "standard deviation along each axis"}},
                         {}});

Bench bench_of(std::int64_t paths, std::vector<double> nm = {550}, std::uint64_t seed = 0,
               double width = 10) {
  TraceSettings trace;
  trace.paths = paths, trace.seed = seed, trace.threads = 2;
  return {SpectralGrid::over(360, 830), 1, {std::move(nm), width}, trace};
}
Specimen specimen_of(const std::string& element) { return {.name = "sample", .element = element}; }
Specimen lambertian(double reflectance) { return lambertian_standard(reflectance); }
Specimen coated() {
  return specimen_of(
      R"(<bsdf type="plastic"><float name="diffuse_reflectance" value="0.5"/><boolean name="nonlinear" value="true"/>
      <float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/></bsdf>)");
}
SpectrophotometerSettings at(const std::string& geometry, bool transmission = false) {
  SpectrophotometerSettings s;
  s.geometry = measuring_geometry(geometry, transmission);
  return s;
}
/// The first value, within 4.5 standard errors and `tolerance` of what is expected, with an error small enough to mean something.
void expect_reading(const MeasuredSpectrum& m, double expected, double tolerance, const std::string& what) {
  EXPECT_NEAR(m.values[0], expected, 4.5 * m.error(0) + tolerance * expected)
      << what << ", error " << m.error(0);
  EXPECT_LT(m.error(0), 0.012 * expected + 1e-4) << what;
}
std::string message_of(const std::function<void()>& f) {
  try {
    f();
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

TEST(Spectrophotometer, LambertianSampleReadsItsReflectanceInEveryGeometry) {
  for (const MeasuringGeometry& g : measuring_geometries(false)) {
    SpectrophotometerSettings s = at(g.name);
    // One port, of which sample and standard take turns, reads what the sphere makes of it: see the test of substitution.
    if (g.name == "d:d") s.standard = 0.3;
    expect_reading(
        measure_spectrum(bench_of(g.name.starts_with("8:") ? 1 << 19 : 1 << 17), lambertian(0.3), s), 0.3,
        5e-3, g.name);
    if (!g.has_sphere()) continue;
    s.by_theory = true;
    expect_reading(measure_spectrum(bench_of(1 << 13), lambertian(0.3), s), 0.3, 1e-4, g.name + " by theory");
  }
}

// Saunderson's closed forms for a Lambertian base of 0.5 under an index of 1.5, with Fresnel's transmittances of the directions
// (own computation in double precision).
TEST(Spectrophotometer, CoatedLambertianReadsSaundersonsValues) {
  expect_reading(measure_spectrum(bench_of(1 << 14), coated(), at("45a:0")), 0.288697, 2e-3, "45a:0");
  expect_reading(measure_spectrum(bench_of(1 << 14), coated(), at("0:45x")), 0.288697, 2e-3, "0:45x");
  for (const auto& [name, expected] :
       {std::pair("di:8", 0.316075), {"de:8", 0.276069}, {"8:di", 0.316075}, {"8:de", 0.276069}}) {
    expect_reading(measure_spectrum(bench_of(1 << 18), coated(), at(name)), expected, 8e-3, name);
    SpectrophotometerSettings s = at(name);
    s.by_theory = true;
    expect_reading(measure_spectrum(bench_of(1 << 16), coated(), s), expected, 1.5e-3,
                   std::string(name) + " by theory");
  }
}

TEST(Spectrophotometer, AbsoluteMethodNeedsNoStandard) {
  for (const char* name : {"45x:0", "di:8", "8:di", "d:d"})
    for (const bool by_theory : {false, true}) {
      SpectrophotometerSettings s = at(name);
      if (by_theory && !s.geometry.has_sphere()) continue;
      // The standard is not used: a wrong one changes nothing.
      s.method = Method::absolute, s.standard = 0.5, s.by_theory = by_theory;
      // A sphere that collects is traced from the lamp to a patch of its wall, which few paths reach.
      const bool is_noisy = s.geometry.view >= MeasuringGeometry::End::sphere && !by_theory;
      const MeasuredSpectrum m = measure_spectrum(bench_of(1 << (is_noisy ? 18 : 17)), lambertian(0.3), s);
      EXPECT_NEAR(m.values[0], 0.3, 4.5 * m.error(0) + (is_noisy ? 2e-3 : 6e-4)) << name;
      EXPECT_LT(m.error(0), is_noisy ? 8e-3 : 3.7e-3) << name;
    }
  SpectrophotometerSettings s;
  s.geometry = measuring_geometry("0:0", true), s.method = Method::absolute;
  const MeasuredSpectrum m = measure_spectrum(bench_of(1 << 14), lambertian(0.3), s);
  EXPECT_NEAR(m.values[0], 0, 1e-6);
  EXPECT_NE(m.notes.at(0).find("incident flux"), std::string::npos);
}

// The sphere's departure from its theory, fitted over the wavelengths: the value stays, the noise falls.
TEST(Spectrophotometer, PooledReadingsAreTracedReadingsWithLessNoise) {
  std::vector<double> nm;
  for (int k = 0; k < 21; ++k) nm.push_back(450 + 10 * k);
  Specimen paint{
      .name = "ramp",
      .element = "<bsdf type=\"diffuse\"><spectrum name=\"reflectance\" value=\"400:0.1, 700:0.7\"/></bsdf>"};
  for (const char* name : {"di:8", "8:de", "d:0"}) {
    SpectrophotometerSettings s = at(name);
    const MeasuredSpectrum alone = measure_spectrum(bench_of(1 << 15, nm), paint, s);
    s.is_pooled = true;
    const MeasuredSpectrum pooled = measure_spectrum(bench_of(1 << 15, nm), paint, s);
    double alone2 = 0, pooled2 = 0, z2 = 0;
    for (std::size_t i = 0; i < nm.size(); ++i) {
      const double expected = 0.1 + 0.6 * (nm[i] - 400) / 300;
      alone2 += std::pow(alone.error(i) / expected, 2), pooled2 += std::pow(pooled.error(i) / expected, 2);
      // Light that a sample sends to its own baffle returns to it: up to 0.3 % of the traced sphere's readings.
      z2 += std::pow((pooled.values[i] - expected) / std::hypot(pooled.error(i), 3e-3 * expected), 2);
      EXPECT_NEAR(pooled.values[i], expected, 5 * pooled.error(i) + 4e-3 * expected) << name << " " << nm[i];
    }
    EXPECT_LT(std::sqrt(pooled2), 0.9 * std::sqrt(alone2)) << name;
    EXPECT_LT(z2 / double(nm.size()), 4) << name;
  }
}

// Standard errors of pooled readings against the spread over seeds.
TEST(Spectrophotometer, ErrorsOfPooledReadingsAreNeitherTooSmallNorTooLarge) {
  Specimen paint{
      .name = "ramp",
      .element = "<bsdf type=\"diffuse\"><spectrum name=\"reflectance\" value=\"400:0.1, 700:0.7\"/></bsdf>"};
  SpectrophotometerSettings s = at("di:8");
  s.is_pooled = true;
  const std::vector<double> nm{480, 520, 560, 600, 640};
  std::vector<double> mean(nm.size()), square(nm.size()), stated(nm.size());
  constexpr int kSeeds = 24;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const MeasuredSpectrum m = measure_spectrum(bench_of(1 << 12, nm, std::uint64_t(seed)), paint, s);
    for (std::size_t i = 0; i < nm.size(); ++i)
      mean[i] += m.values[i] / kSeeds, square[i] += m.values[i] * m.values[i] / kSeeds,
          stated[i] += m.error(i) * m.error(i) / kSeeds;
  }
  double ratio = 0;
  for (std::size_t i = 0; i < nm.size(); ++i)
    ratio += (square[i] - mean[i] * mean[i]) * kSeeds / (kSeeds - 1) / stated[i] / double(nm.size());
  // 23 degrees of freedom, and bands that share their paths: the chi-square quotient lies within 0.4 and 2 (level 0.003).
  EXPECT_GT(ratio, 0.4);
  EXPECT_LT(ratio, 2);
}

TEST(Spectrophotometer, SubstitutionMakesADarkSampleDarker) {
  // 0.2 (1 - 0.97 0.95 - 0.02 0.99)/(1 - 0.97 0.95 - 0.02 0.2)
  const IntegratingSphere sphere{.wall = 0.97, .ports = 0.03, .sample_port = 0.02};
  EXPECT_NEAR(sphere.by_substitution(0.2, 0.2, 0.99), 0.15758, 5e-6);
  // The traced sphere errs as much.
  SpectrophotometerSettings s = at("di:8");
  s.method = Method::substitution, s.port_m = 40e-3;
  const MeasuredSpectrum traced = measure_spectrum(bench_of(1 << 18), lambertian(0.2), s);
  s.by_theory = true;
  const MeasuredSpectrum theory = measure_spectrum(bench_of(1 << 14), lambertian(0.2), s);
  EXPECT_LT(theory.values[0], 0.19);
  EXPECT_NEAR(traced.values[0], theory.values[0], 4.5 * traced.error(0) + 4e-3 * theory.values[0]);
}

TEST(Spectrophotometer, PortFractionsAreThoseOfCaps) {
  // A cap of half-angle a covers (1 - cos a)/2.
  for (const double a : {0.01, 0.3, 1.2})
    EXPECT_NEAR(port_fraction(2 * std::sin(a), 2), 0.5 * (1 - std::cos(a)), 1e-14);
}

TEST(Spectrophotometer, HazeOfAGaussianSheetIsTheTailOfItsDistribution) {
  Specimen sheet{.name = "sheet"};
  sheet.bsdf = build<Bsdf>("<bsdf type=\"test_gaussian_sheet\"/>");
  SpectrophotometerSettings s = at("0:de", true);
  s.by_theory = true;
  // Narrow cones of lamp and field, which would blur the edge at 2.5 degrees.
  s.lamp_angle = 0.05, s.lit_m = 2e-4, s.viewed_m = 2e-4, s.distance_m = 1;
  const Haze h = measure_haze(bench_of(1 << 18), sheet, s, 2.5, {1});
  EXPECT_NEAR(h.total, 1, 2e-3);
  EXPECT_NEAR(h.haze, std::exp(-0.5 * 2.5 * 2.5), 4.5 * h.haze_error + 0.02 * 0.04394);
  EXPECT_LT(h.haze_error, 0.02 * 0.04394);
  // The traced sphere, with its port behind the sample and its second beam.
  s.by_theory = false;
  const Haze traced = measure_haze(bench_of(1 << 17), sheet, s, 2.5, {1});
  EXPECT_NEAR(traced.haze, std::exp(-0.5 * 2.5 * 2.5), 4.5 * traced.haze_error);
  EXPECT_LT(traced.haze_error, 0.05 * 0.04394);
  EXPECT_GT(traced.haze_error, 0.005 * 0.04394);
  EXPECT_NEAR(traced.total, 1, 4.5 * traced.total_error);
  EXPECT_LT(traced.total_error, 0.015);
}

// Bands share paths: an error that took them for independent would be a quarter of it.
TEST(Spectrophotometer, ErrorOfLuminanceKnowsThatBandsShareTheirPaths) {
  std::vector<double> nm;
  for (double x = 400; x <= 700; x += 20) nm.push_back(x);
  const std::vector<double> weights = luminance_weights(nm);
  Specimen sheet{.name = "sheet"};
  sheet.bsdf = build<Bsdf>("<bsdf type=\"test_gaussian_sheet\"/>");
  SpectrophotometerSettings s = at("0:di", true);
  use_beam_of_haze(s);
  double squares = 0;
  constexpr int kSeeds = 16;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const Haze h = measure_haze(bench_of(1 << 13, nm, std::uint64_t(seed + 1)), sheet, s, 2.5, weights);
    squares += std::pow((h.total - 1) / h.total_error, 2);
    EXPECT_LT(h.total_error, 0.1);
  }
  // The mean of z^2 over 16 seeds, of Student's distribution with 15 degrees of freedom: variance 1.154.
  EXPECT_LT(squares / kSeeds, 2.6);
  EXPECT_GT(squares / kSeeds, 0.3);
}

TEST(Spectrophotometer, AnAreaThatIsNotStatedBesideAnotherIsTheUsualOne) {
  // As for haze, whose own areas are 2 mm.
  const auto areas = [](const StatedBeam& stated) {
    SpectrophotometerSettings s;
    use_beam_of_haze(s), set_beam(s, stated);
    return std::array{s.lamp_angle, s.viewed_m, s.lit_m};
  };
  EXPECT_EQ(areas({}), (std::array{0.1, 2e-3, 2e-3}));
  EXPECT_EQ(areas({.lamp_angle = 1.5}), (std::array{1.5, 2e-3, 2e-3}));
  EXPECT_EQ(areas({.viewed_m = 5e-3}), (std::array{0.1, 5e-3, 5e-3 + 4e-3}));
  EXPECT_EQ(areas({.lit_m = 30e-3}), (std::array{0.1, 8e-3, 30e-3}));
  EXPECT_EQ(areas({1.5, 5e-3, 6e-3}), (std::array{1.5, 5e-3, 6e-3}));
}

Specimen pane_of_index(const std::string& n) {
  Specimen pane{.name = "pane"};
  pane.bsdf = build<Bsdf>("<bsdf type=\"thindielectric\"><float name=\"int_ior\" value=\"" + n +
                          "\"/><float name=\"ext_ior\" value=\"1\"/></bsdf>");
  return pane;
}

TEST(Spectrophotometer, ClearGlassHasNoHazeAndItsTransmittance) {
  // A pane of both surfaces: T = (1 - r)/(1 + r), r = ((n - 1)/(n + 1))^2. The usual settings trace the sphere.
  const Specimen pane = pane_of_index("1.5");
  const double t = (1 - 0.04) / (1 + 0.04);
  for (const bool by_theory : {false, true}) {
    SpectrophotometerSettings s = at("0:de", true);
    s.by_theory = by_theory;
    use_beam_of_haze(s);
    const Haze h = measure_haze(bench_of(1 << 17), pane, s, 2.5, {1});
    EXPECT_NEAR(h.haze, 0, 1e-6) << by_theory;
    EXPECT_NEAR(h.total, t, 4.5 * h.total_error + 1e-4) << by_theory;
    EXPECT_LT(h.total_error, by_theory ? 1e-3 : 8e-3);
  }
}

TEST(Spectrophotometer, APaneInThePortBrightensTheSphereUnlessItHasASecondBeam) {
  const Specimen pane = pane_of_index("1.8");
  const double r = std::pow(0.8 / 2.8, 2), t = (1 - r) / (1 + r);
  SpectrophotometerSettings s = at("0:di", true);
  s.lamp_angle = 0.5, s.lit_m = s.viewed_m = 4e-3, s.distance_m = 1, s.port_m = 50e-3;
  const MeasuredSpectrum both = measure_spectrum(bench_of(1 << 17), pane, s);
  EXPECT_NEAR(both.values[0], t, 4.5 * both.error(0));
  EXPECT_LT(both.error(0), 0.01);
  s.method = Method::substitution;
  const MeasuredSpectrum alone = measure_spectrum(bench_of(1 << 17), pane, s);
  s.by_theory = true;
  const MeasuredSpectrum theory = measure_spectrum(bench_of(1 << 14), pane, s);
  EXPECT_NEAR(alone.values[0], theory.values[0], 4.5 * alone.error(0) + 4e-3);
  EXPECT_GT(alone.values[0], t + 10 * alone.error(0));
}

/// Fresnel's reflectance of unpolarised light, written anew.
double fresnel(double angle, double n) {
  const double t = std::asin(std::sin(angle) / n);
  const double s = std::sin(angle - t) / std::sin(angle + t), p = std::tan(angle - t) / std::tan(angle + t);
  return 0.5 * (s * s + p * p);
}

TEST(Spectrophotometer, GlossOfGlassIsTheRatioOfFresnelsReflectances) {
  for (const double angle : {20.0, 60.0, 85.0}) {
    const double a = angle * M_PI / 180;
    for (const double n : {1.567, 1.4, 1.7}) {
      const Ratio g = measure_gloss(bench_of(1 << 14), black_glass(n), angle, at("di:8"), {1});
      EXPECT_NEAR(g.value, 100 * fresnel(a, n) / fresnel(a, 1.567), 0.6) << angle << " degrees, index " << n;
      EXPECT_LT(g.error, 0.2) << angle << " degrees, index " << n;
    }
    // A rough surface spreads light beyond the receptor.
    const Ratio matt =
        measure_gloss(bench_of(1 << 14),
                      specimen_of(R"(<bsdf type="roughplastic"><float name="diffuse_reflectance" value="0"/>
        <float name="alpha" value="0.3"/><float name="int_ior" value="1.567"/><float name="ext_ior" value="1"/></bsdf>)"),
                      angle, at("di:8"), {1});
    EXPECT_LT(matt.value, 60) << angle;
    EXPECT_GT(matt.value, 0) << angle;
  }
  EXPECT_NE(message_of([] {
              measure_gloss(bench_of(1 << 10), black_glass(1.5), 45, at("di:8"), {1});
            }).find("ISO 2813 has 20, 60 and 85"),
            std::string::npos);
}

TEST(Spectrophotometer, TransmittancesOfClearAndScatteringSheets) {
  // A mask lets one part pass unchanged; the rest is black.
  Specimen grey{.name = "grey"};
  grey.bsdf = build<Bsdf>(
      R"(<bsdf type="mask"><float name="opacity" value="0.6"/><bsdf type="diffuse"><float name="reflectance" value="0"/></bsdf></bsdf>)");
  for (const MeasuringGeometry& g : measuring_geometries(true)) {
    const bool excludes = g.name.find("de") != std::string::npos;
    if (excludes) continue;
    SpectrophotometerSettings s = at(g.name, true);
    const MeasuredSpectrum m = measure_spectrum(bench_of(1 << 17), grey, s);
    EXPECT_NEAR(m.values[0], 0.4, 4.5 * m.error(0) + 0.01) << g.name;
    EXPECT_LT(m.error(0), 0.02) << g.name;
  }
}

// A pane passes (1 - R)/(1 + R) of the light, R = 0.04 for an index of 1.5, by reflections within; one surface of glass has no
// transmittance in air.
TEST(Spectrophotometer, PanesOfGlassAreSlabs) {
  Specimen glass{.name = "glass"};
  glass.bsdf = build<Bsdf>(
      R"(<bsdf type="dielectric"><float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/></bsdf>)");
  SpectrophotometerSettings s = at("0:0", true);
  EXPECT_NE(message_of([&] { measure_spectrum(bench_of(64), glass, s); }).find("a body of index 1.5"),
            std::string::npos);
  glass.thickness_m = 3e-3;
  const MeasuredSpectrum m = measure_spectrum(bench_of(1 << 14), glass, s);
  EXPECT_NEAR(m.values[0], 0.96 / 1.04, 4.5 * m.error(0) + 1e-3);
  EXPECT_LT(m.error(0), 4e-3);
}

TEST(Spectrophotometer, TranslucentSamplesLoseLightAtTheEdgeOfSmallPorts) {
  // A slab of scattering medium with the index of air: what enters through the port leaves beside it.
  Specimen slab{.name = "slab"};
  slab.bsdf = build<Bsdf>("<bsdf type=\"null\"/>");
  slab.medium = build<Medium>(
      R"(<medium type="homogeneous"><float name="albedo" value="0.999"/><float name="sigma_t" value="1000"/></medium>)");
  slab.thickness_m = 20e-3;
  double before = 0;
  for (const double port : {6e-3, 15e-3, 40e-3}) {
    SpectrophotometerSettings s = at("de:8");
    s.by_theory = true, s.port_m = port, s.viewed_m = 0.6 * port, s.lit_m = port, s.sample_m = 120e-3;
    const MeasuredSpectrum m = measure_spectrum(bench_of(1 << 15), slab, s);
    EXPECT_GT(m.values[0], before + 4 * m.error(0)) << port;
    before = m.values[0];
  }
  EXPECT_GT(before, 0.6);
}

// Edge loss that diffusion predicts against the loss of traced light, which knows nothing of diffusion.
TEST(Spectrophotometer, EdgeLossIsPredictedWithoutTracing) {
  Specimen slab{.name = "slab", .thickness_m = 20e-3};
  slab.bsdf = build<Bsdf>(R"(<bsdf type="null"/>)");
  slab.medium = build<Medium>(
      R"(<medium type="homogeneous"><float name="sigma_t" value="1000"/><float name="albedo" value="0.999"/></medium>)");
  const auto read = [&](double port_m, double* predicted) {
    SpectrophotometerSettings s = at("de:8");
    s.by_theory = true, s.port_m = port_m, s.viewed_m = std::min(0.6 * port_m, 12e-3), s.lit_m = port_m,
    s.sample_m = 0.3;
    const MeasuredSpectrum m = measure_spectrum(bench_of(1 << 14), slab, s);
    *predicted = m.edge_loss.at(0);
    return m.values[0];
  };
  double of_wide = 0, of_middle = 0, of_small = 0;
  const double wide = read(80e-3, &of_wide), middle = read(25e-3, &of_middle), small = read(8e-3, &of_small);
  EXPECT_LT(of_wide, 0.01);
  EXPECT_NEAR((1 - of_middle) / (1 - of_wide), middle / wide, 0.03);
  EXPECT_NEAR((1 - of_small) / (1 - of_wide), small / wide, 0.05);
  EXPECT_GT(1 - small / wide, 0.25);
  // A surface without depth loses nothing there.
  EXPECT_TRUE(measure_spectrum(bench_of(1 << 12), lambertian(0.3), at("45a:0")).edge_loss.empty());
}

TEST(Spectrophotometer, BandwidthIsCorrectedForParabolas) {
  const Specimen parabola = specimen_of(
      R"(<bsdf type="diffuse"><spectrum name="reflectance" value="450:0.7, 470:0.52, 490:0.38, 510:0.28, 530:0.22, 550:0.2, 570:0.22, 590:0.28, 610:0.38, 630:0.52, 650:0.7"/></bsdf>)");
  // Steps of 20 nm are the scene's own parabola, R'' = 1e-4, so that bands of 20 nm read 20^2/12 R'' too much at its nodes.
  SpectrophotometerSettings s = at("45x:0");
  const Bench bench = bench_of(1 << 16, {490, 510, 530, 550, 570, 590, 610}, 0, 20);
  const MeasuredSpectrum raw = measure_spectrum(bench, parabola, s);
  s.correct_bandwidth = true;
  const MeasuredSpectrum corrected = measure_spectrum(bench, parabola, s);
  // A triangle over a spectrum that is linear between the nodes: the mean of both slopes adds 20/3 times 0.001.
  EXPECT_NEAR(raw.values[3], 0.2 + 20.0 / 3 * 0.001, 6e-4);
  EXPECT_NEAR(corrected.values[3], raw.values[3] - 20 * 20 / 12.0 * 1e-4, 4e-4);
}

TEST(Spectrophotometer, ACorrectedBandwidthKnowsThatBandsShareTheirPaths) {
  const Specimen sheet = lambertian(0.4);
  const std::vector<double> nm{500, 520, 540, 560, 580};
  double squares = 0;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SpectrophotometerSettings s = at("di:8");
    s.correct_bandwidth = true;
    const MeasuredSpectrum m = measure_spectrum(bench_of(1 << 12, nm, seed, 40), sheet, s);
    for (std::size_t i = 0; i < nm.size(); ++i) {
      std::vector<double> alone(nm.size());
      alone[i] = 1;
      // The deviations are those of the corrected values.
      EXPECT_NEAR(m.error_of_sum(alone), m.error(i), 1e-9 * m.error(i));
      squares += std::pow((m.values[i] - 0.4) / m.error(i), 2), ++count;
    }
  }
  EXPECT_GT(squares / count, 0.3);
  EXPECT_LT(squares / count, 2.5);
  // Bands are independent in the detector's noise: the variance is multiplied by (1 + 2 a)^2 and 2 a^2, a = (40/20)^2/12, or by
  // (1 + a)^2 and a^2 at the ends.
  SpectrophotometerSettings s = at("45x:0");
  s.noise = 0.01;
  const Bench bench = bench_of(1 << 10, nm, 0, 40);
  const auto detector = [](const MeasuredSpectrum& m) {
    for (const auto& cause : m.causes)
      if (cause.name == "detector") return cause.errors;
    return std::vector<double>();
  };
  const std::vector<double> raw = detector(measure_spectrum(bench, sheet, s));
  s.correct_bandwidth = true;
  const std::vector<double> corrected = detector(measure_spectrum(bench, sheet, s));
  ASSERT_EQ(raw.size(), nm.size());
  const double a = 1.0 / 3;
  EXPECT_NEAR(corrected[2],
              std::sqrt(std::pow((1 + 2 * a) * raw[2], 2) + a * a * (raw[1] * raw[1] + raw[3] * raw[3])),
              1e-9);
  EXPECT_NEAR(corrected[0], std::sqrt(std::pow((1 + a) * raw[0], 2) + std::pow(a * raw[1], 2)), 1e-9);
}

TEST(Spectrophotometer, StandardErrorsAreNeitherTooSmallNorTooLarge) {
  double squares = 0;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SpectrophotometerSettings s = at("di:8");
    s.noise = 0.002;
    const MeasuredSpectrum m = measure_spectrum(bench_of(1 << 14, {450, 550, 650}, seed), lambertian(0.3), s);
    for (std::size_t i = 0; i < 3; ++i, ++count) squares += std::pow((m.values[i] - 0.3) / m.error(i), 2);
  }
  // Of chi squared with 36 degrees of freedom, of which values of one seed share some noise.
  EXPECT_GT(squares / count, 0.4);
  EXPECT_LT(squares / count, 2.0);
}

TEST(Spectrophotometer, FilesAreReadByThePigmentCommands) {
  pigment::SampleTable table{{400, 410, 420}, {}};
  pigment::Sample& sample = table.samples.emplace_back();
  sample.name = "ochre", sample.values = {0.125, 0.25, 0.375};
  for (const auto& [name, geometry, specular] :
       {std::tuple("x.csv", "", ""), {"x.cxf", "45_0", "excluded"}, {"x.cgats", "45_0", "excluded"}}) {
    const std::string path = ::testing::TempDir() + name;
    std::ofstream(path) << spectrum_file_content(path, table, "45a:0");
    const pigment::SampleTable read = read_sample_file(path, pigment::Recipes::optional);
    EXPECT_EQ(read.nm, table.nm) << name;
    ASSERT_EQ(read.samples.size(), 1u) << name;
    EXPECT_EQ(read.samples[0].values, sample.values) << name;
    EXPECT_EQ(read.instrument.geometry, geometry) << name;
    EXPECT_EQ(read.instrument.specular, specular) << name;
  }
  for (const auto& [geometry, specular] : {std::pair("di:8", "included"), {"8:de", "excluded"}}) {
    const std::string path = ::testing::TempDir() + "sphere.cxf";
    std::ofstream(path) << spectrum_file_content(path, table, geometry);
    const pigment::SampleTable read = read_sample_file(path, pigment::Recipes::optional);
    EXPECT_EQ(read.instrument.geometry, "d8") << geometry;
    EXPECT_EQ(read.instrument.specular, specular) << geometry;
  }
  EXPECT_NE(message_of([&] { spectrum_file_content("x.doc", table, "45a:0"); }).find("the ending says"),
            std::string::npos);
}

TEST(Spectrophotometer, BadSizesAndNamesAreErrorsThatSayWhatIsExpected) {
  EXPECT_NE(message_of([] { measuring_geometry("45:90", false); }).find("there are 45a:0, 45x:0"),
            std::string::npos);
  EXPECT_NE(message_of([] { measuring_geometry("0:0", false); }).find("with --transmission it is one"),
            std::string::npos);
  const auto fails = [](auto change, const std::string& expected) {
    SpectrophotometerSettings s = at("di:8");
    change(s);
    const std::string message = message_of([&] { measure_spectrum(bench_of(1 << 8), lambertian(0.5), s); });
    EXPECT_NE(message.find(expected), std::string::npos) << message;
  };
  fails([](auto& s) { s.port_m = 0.2; }, "a port of 200 mm does not fit a sphere of 150 mm");
  fails([](auto& s) { s.sample_m = 10e-3; }, "the sample of 10 mm is smaller than the spot of 25 mm");
  fails([](auto& s) { s.viewed_m = 30e-3; }, "larger than the port");
  fails([](auto& s) { s.wall = 1; }, "a wall's reflectance of 1");
  fails([](auto& s) { s.wall = NAN; }, "a wall's reflectance of nan");
  fails([](auto& s) { s.geometry = measuring_geometry("45a:0", false), s.by_theory = true; },
        "has no sphere");
  fails([](auto& s) { s.geometry = measuring_geometry("de:8", false), s.detector_angle = 6.5; }, "overlap");
  EXPECT_NE(message_of([] { bench_of(1 << 8, {300}); }).find("outside of the scene's wavelengths"),
            std::string::npos);
  EXPECT_NE(message_of([] { bench_of(1 << 8, {500, 400}); }).find("must increase"), std::string::npos);
}

}  // namespace
}  // namespace aureole::testing
