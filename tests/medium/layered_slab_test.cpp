// SPDX-License-Identifier: Apache-2.0
// `layered` against paths through the same layers and interfaces, within 3 standard errors and .3 %: all light of
// a sky, along the normal (a prism between mirrors), and that of one lamp (wide layers). And `paint`, against the same
// paths: Kubelka and Munk's two fluxes are off by differences that are written here.
//
// AUREOLE_THOROUGH=1 follows a million paths per number and prints what it finds.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>

#include "aureole/bsdf/bsdf.h"
#include "aureole/parameter/palette_file.h"
#include "harness/paths.h"
#include "harness/properties_builder.h"
#include "harness/rendered.h"
#include "loading/load_text.h"
#include "medium/slab_scenes.h"

namespace aureole::testing {
namespace {

struct Coat {
  const char* name;
  double albedo, thickness, g, index, alpha;
  const char* substrate;  ///< black, white, metal, or none: open below
};

std::string substrate_of(const Coat& c) {
  const std::string kind = c.substrate;
  if (kind == "metal") return "<bsdf type=\"conductor\"><string name=\"material\" value=\"none\"/></bsdf>";
  return "<bsdf type=\"diffuse\">" + parameter("reflectance", kind == "white" ? 0.9 : 0) + "</bsdf>";
}

std::string medium_of(const Coat& c, double extinction, const std::string& name) {
  return "<medium type=\"homogeneous\"" + name + ">" + parameter("sigma_t", extinction) +
         parameter("albedo", c.albedo) + "<phase type=\"hg\">" + parameter("g", c.g) + "</phase></medium>";
}

std::string interface_of(const Coat& c) {
  if (c.index == 1) return "<bsdf type=\"null\"/>";
  const std::string indices = parameter("ext_ior", 1) + parameter("int_ior", c.index) + "</bsdf>";
  if (c.alpha == 0) return "<bsdf type=\"dielectric\">" + indices;
  return "<bsdf type=\"roughdielectric\"><string name=\"distribution\" value=\"ggx\"/><boolean "
         "name=\"energy_preserving\" value=\"true\"/>" +
         parameter("alpha", c.alpha) + indices;
}

/// The coat as one surface, a metre thick.
std::string layered(const Coat& c, const std::string& more = "") {
  const bool open = std::string(c.substrate) == "none";
  return "<bsdf type=\"layered\"><string name=\"thickness\" value=\"1m\"/><string name=\"distribution\" "
         "value=\"ggx\"/>" +
         medium_of(c, c.thickness, "") + parameter("int_ior", c.index) +
         (c.alpha > 0 ? "<string name=\"alpha\" value=\"" + number(c.alpha) +
                            (open ? ", " + number(c.alpha) : "") + "\"/>"
                      : "") +
         (open ? "" : substrate_of(c)) + more + "</bsdf>";
}

std::string looking_down(double half, int samples) {
  return "<integrator type=\"path\"/><sensor type=\"orthographic\"><transform name=\"to_world\"><scale "
         "value=\"" +
         number(half) + "\"/><lookat origin=\"0, 0, 2.5\" target=\"0, 0, 0\" up=\"0, 1, 0\"/></transform>" +
         film(8, samples) + "</sensor>";
}

/// Light that leaves the coat along its normal under a sky. Its faces are at the heights 0 and 1.
Picture under_sky(const Coat& c, int usual_samples = 24) {
  std::string scene = looking_down(0.99, is_thorough() ? 1024 : usual_samples) + kSky + mirrors();
  scene += level(1, true, interface_of(c) + medium_of(c, c.thickness, " name=\"interior\""));
  if (std::string(c.substrate) == "none")
    scene += level(0, false, interface_of(c) + medium_of(c, c.thickness, " name=\"interior\""));
  else
    scene += level(0, true, substrate_of(c) + medium_of(c, c.thickness, " name=\"exterior\""));
  return render(scene);
}

const Coat kCoats[] = {{"ThinOverBlack", .9, .5, 0, 1.5, 0, "black"},
                       {"ThickOverBlack", .99, 20, .5, 1.5, 0, "black"},
                       {"AbsorbingOverWhite", .5, .5, .8, 1.33, 0, "white"},
                       {"WhiteOverMetal", 1, 1, .3, 1.5, 0, "metal"},
                       {"BareOverMetal", .8, .4, .8, 1, 0, "metal"},
                       {"RoughOverWhite", .8, 1, .5, 1.5, .3, "white"},
                       {"RoughOverMetal", .9, .3, 0, 1.5, .15, "metal"},
                       {"RoughThick", .99, 20, .8, 1.5, .4, "black"},
                       {"OpenRough", .9, 2, .5, 1.5, .3, "none"}};

/// Light along the normal that leaves again: value over density of any sample. Open slabs have the sky on both sides.
double all_that_leaves(const Bsdf& bsdf) {
  const Wavelengths w = Wavelengths::at(make_context()->grid, Spectrum(550.f));
  const SurfacePoint point;
  const auto s = bsdf.sample({0, 0, 1}, 0.5f, {0.4f, 0.6f}, {w, point, TransportMode::importance});
  return s ? double(s->value[0] / s->pdf[0]) : 0;
}

class LayeredSlab : public ::testing::TestWithParam<Coat> {};

TEST_P(LayeredSlab, ReflectsTheSkyAsPathsDo) {
  const std::string name = GetParam().name;
  // Coats that are not among the combinations below; the others for the table of docs/pigments.md.
  if (name != "AbsorbingOverWhite" && name != "BareOverMetal" && name != "OpenRough" && !is_thorough())
    GTEST_SKIP() << "AUREOLE_THOROUGH=1";
  const double expected = all_that_leaves(*build<Bsdf>(layered(GetParam())));
  const Picture p = under_sky(GetParam());
  if (is_thorough())
    std::printf("%s: paths %.6f +- %.6f, layered %.6f (%+.2f %%)\n", GetParam().name, p.all, p.all_error,
                expected, 100 * (expected / p.all - 1));
  EXPECT_NEAR(p.all, expected, 3 * p.all_error + 0.003 * expected);
  EXPECT_LT(p.all_error, 0.03 * expected);
}
INSTANTIATE_TEST_SUITE_P(Of, LayeredSlab, ::testing::ValuesIn(kCoats),
                         [](const auto& i) { return std::string(i.param.name); });

/// The light of a lamp at 45 degrees, seen along the normal, on layers a hundredth as thick as they are wide.
Picture under_lamp(const std::string& surfaces) {
  return render(
      looking_down(0.2, is_thorough() ? 1024 : 32) + surfaces +
      "<shape type=\"sphere\"><point name=\"center\" x=\"2\" y=\"0\" z=\"2\"/><float name=\"radius\" value=\"0.9\"/>"
      "<emitter type=\"area\">" +
      parameter("radiance", 1) + "</emitter></shape>");
}

class LayeredUnderLamp : public ::testing::TestWithParam<Coat> {};

TEST_P(LayeredUnderLamp, ReflectsItAsPathsDo) {
  const Coat& c = GetParam();
  if (std::string(c.name) == "RoughOverMetal" && !is_thorough()) GTEST_SKIP() << "AUREOLE_THOROUGH=1";
  constexpr double kThickness = 0.01;
  const double sigma = c.thickness / kThickness;
  const std::clock_t start = std::clock();
  const Picture paths =
      under_lamp(level(0, true, interface_of(c) + medium_of(c, sigma, " name=\"interior\""), 2) +
                 level(-kThickness, true, substrate_of(c) + medium_of(c, sigma, " name=\"exterior\""), 2));
  const std::clock_t between = std::clock();
  const Picture table = under_lamp(level(0, true, layered(c), 2));
  const double path_work = double(between - start) * paths.all_error * paths.all_error,
               table_work = double(std::clock() - between) * table.all_error * table.all_error;
  if (is_thorough())
    std::printf("%s, lamp: paths %.6f +- %.6f, layered %.6f +- %.6f (%+.2f %%)\n", c.name, paths.all,
                paths.all_error, table.all, table.all_error, 100 * (table.all / paths.all - 1)),
        std::printf(
            "  CPU time (%.1f s and %.1f s, the table's included) times squared error: %.0f times less\n",
            double(between - start) / CLOCKS_PER_SEC, double(std::clock() - between) / CLOCKS_PER_SEC,
            path_work / table_work);
  EXPECT_NEAR(paths.all, table.all, 3 * std::hypot(paths.all_error, table.all_error) + 0.003 * table.all);
  EXPECT_LT(paths.all_error, 0.06 * table.all);
}
INSTANTIATE_TEST_SUITE_P(Of, LayeredUnderLamp, ::testing::Values(kCoats[1], kCoats[4], kCoats[6]),
                         [](const auto& i) { return std::string(i.param.name); });

/// All that a surface reflects of light along its normal, by a lattice of samples.
double reflected_along_normal(const Bsdf& bsdf, const Wavelengths& w) {
  const SurfacePoint point;
  constexpr int kSamples = 1 << 16;
  double sum = 0;
  for (int i = 0; i < kSamples; ++i) {
    const auto place = [&](double step) { return float(std::fmod((i + 0.5) * step, 1.0)); };
    // The lattice of the plastic number, in three dimensions (Roberts 2018).
    const auto s = bsdf.sample({0, 0, 1}, place(0.8191725133961645),
                               {place(0.6710436067037893), place(0.5497004779019703)},
                               {w, point, TransportMode::importance});
    if (s) sum += double(s->value[0] / s->pdf[0]);
  }
  return sum / kSamples;
}

/// The reflectance of `paint` with K and S of the same layer. A metal counts as a perfect diffuse reflector.
double two_fluxes(const Coat& c) {
  const auto context = make_context();
  const double scattering = c.thickness * c.albedo, k = 2 * (c.thickness - scattering),
               s = 0.75 * scattering * (1 - c.g);
  test::TemporaryFolder folder;
  const auto file = folder.path / "palette.csv";
  std::ofstream(file) << "unit,1/m\nnm,x K,x S\n400," << number(k) << "," << number(s) << "\n700,"
                      << number(k) << "," << number(s) << "\n";
  const std::string below = c.substrate;
  const auto paint = build<Bsdf>(
      "<bsdf type=\"paint\"><string name=\"palette\" value=\"" + file.string() +
          "\"/><string name=\"recipe\" value=\"x\"/><string name=\"thickness\" value=\"1m\"/>" +
          parameter("substrate", below == "metal"   ? 1
                                 : below == "white" ? 0.9
                                                    : 0) +
          parameter("int_ior", c.index) + parameter("ext_ior", 1) +
          (c.alpha > 0 ? "<string name=\"distribution\" value=\"ggx\"/>" + parameter("alpha", c.alpha) : "") +
          "</bsdf>",
      context);
  return reflected_along_normal(*paint, Wavelengths::at(context->grid, Spectrum(550.f)));
}

/// Smooth and rough, thin and thick, white and absorbing layers, over black, white and metal.
struct Combination {
  Coat coat;
  double paint_is_off;  ///< its reflectance, less that of `layered`
};
constexpr double kThin = 0.5, kThick = 4, kWhite = 1, kAbsorbing = 0.8, kRough = 0.4;
const Combination kCombinations[] = {
    {{"SmoothThinWhiteOverBlack", kWhite, kThin, 0, 1.5, 0, "black"}, 0.0459},
    {{"SmoothThinWhiteOverWhite", kWhite, kThin, 0, 1.5, 0, "white"}, 0.0038},
    {{"SmoothThinWhiteOverMetal", kWhite, kThin, 0, 1.5, 0, "metal"}, -0.0002},
    {{"SmoothThinAbsorbingOverBlack", kAbsorbing, kThin, 0, 1.5, 0, "black"}, 0.0343},
    {{"SmoothThinAbsorbingOverWhite", kAbsorbing, kThin, 0, 1.5, 0, "white"}, -0.0260},
    {{"SmoothThinAbsorbingOverMetal", kAbsorbing, kThin, 0, 1.5, 0, "metal"}, -0.1217},
    {{"SmoothThickWhiteOverBlack", kWhite, kThick, 0, 1.5, 0, "black"}, 0.0323},
    {{"SmoothThickWhiteOverWhite", kWhite, kThick, 0, 1.5, 0, "white"}, 0.0075},
    {{"SmoothThickWhiteOverMetal", kWhite, kThick, 0, 1.5, 0, "metal"}, -0.0002},
    {{"SmoothThickAbsorbingOverBlack", kAbsorbing, kThick, 0, 1.5, 0, "black"}, 0.0298},
    {{"SmoothThickAbsorbingOverWhite", kAbsorbing, kThick, 0, 1.5, 0, "white"}, 0.0278},
    {{"SmoothThickAbsorbingOverMetal", kAbsorbing, kThick, 0, 1.5, 0, "metal"}, 0.0271},
    {{"RoughThinWhiteOverBlack", kWhite, kThin, 0.5, 1.5, kRough, "black"}, 0.0341},
    {{"RoughThinWhiteOverWhite", kWhite, kThin, 0.5, 1.5, kRough, "white"}, 0.0049},
    {{"RoughThinWhiteOverMetal", kWhite, kThin, 0.5, 1.5, kRough, "metal"}, 0.0001},
    {{"RoughThinAbsorbingOverBlack", kAbsorbing, kThin, 0.5, 1.5, kRough, "black"}, 0.0242},
    {{"RoughThinAbsorbingOverWhite", kAbsorbing, kThin, 0.5, 1.5, kRough, "white"}, -0.0314},
    {{"RoughThinAbsorbingOverMetal", kAbsorbing, kThin, 0.5, 1.5, kRough, "metal"}, -0.1236},
    {{"RoughThickWhiteOverBlack", kWhite, kThick, 0.5, 1.5, kRough, "black"}, 0.0481},
    {{"RoughThickWhiteOverWhite", kWhite, kThick, 0.5, 1.5, kRough, "white"}, 0.0112},
    {{"RoughThickWhiteOverMetal", kWhite, kThick, 0.5, 1.5, kRough, "metal"}, 0.0001},
    {{"RoughThickAbsorbingOverBlack", kAbsorbing, kThick, 0.5, 1.5, kRough, "black"}, 0.0311},
    {{"RoughThickAbsorbingOverWhite", kAbsorbing, kThick, 0.5, 1.5, kRough, "white"}, 0.0252},
    {{"RoughThickAbsorbingOverMetal", kAbsorbing, kThick, 0.5, 1.5, kRough, "metal"}, 0.0233}};

std::ostream& operator<<(std::ostream& out, const Combination& c) { return out << c.coat.name; }

class CoatsOfPaint : public ::testing::TestWithParam<Combination> {};

TEST_P(CoatsOfPaint, AreThoseOfPaths) {
  const auto& [coat, paint_is_off] = GetParam();
  // Fluxes need few directions in the table, whose energy is that of the solution.
  const double all = all_that_leaves(*build<Bsdf>(layered(
                   coat,
                   "<integer name=\"directions\" value=\"16\"/><integer name=\"azimuths\" value=\"8\"/>"))),
               paint = two_fluxes(coat);
  // Light is long in a thick white coat.
  const Picture p = under_sky(coat, coat.thickness * coat.albedo > 3.5 ? 6 : 12);
  std::printf("%-30s paths %.4f +- %.4f, layered %.4f, paint %.4f (%+.4f)\n", coat.name, p.all, p.all_error,
              all, paint, paint - all);
  EXPECT_NEAR(p.all, all, 3 * p.all_error + 0.003 * all);
  EXPECT_NEAR(p.all, paint - paint_is_off, 3 * p.all_error + 0.003 * all);
  EXPECT_NEAR(paint - all, paint_is_off, 0.001);
}
INSTANTIATE_TEST_SUITE_P(Of, CoatsOfPaint, ::testing::ValuesIn(kCombinations),
                         [](const auto& i) { return std::string(i.param.coat.name); });

/// Other layers, by `layered` alone: the table of docs/pigments.md.
TEST(PaintSlab, TwoFluxesAreOffByThis) {
  const Combination cases[] = {{{"white, thick, over black", .999, 100, 0, 1.5, 0, "black"}, .0064},
                               {{"white, thick, rough", .999, 100, .5, 1.5, .3, "black"}, .012},
                               {{"thick, over black", .99, 20, .5, 1.5, 0, "black"}, .030},
                               {{"dark, thick", .5, 20, 0, 1.5, 0, "black"}, .015},
                               {{"thin, over black", .9, .5, 0, 1.5, 0, "black"}, .0401},
                               {{"thin, over white", .9, .5, 0, 1.5, 0, "white"}, -.010},
                               {{"thin, over metal", .9, .5, 0, 1.5, 0, "metal"}, -.063},
                               {{"forward, thin, over white", .9, 1, .9, 1.5, 0, "white"}, -.049},
                               {{"absorbing, over white", .5, .5, .8, 1.33, 0, "white"}, -.0957},
                               {{"clear glaze, over white", 0, .5, 0, 1.5, 0, "white"}, -.079}};
  for (std::size_t i = 0; i < std::size(cases); ++i) {
    if (i % 4 != 0 && !is_thorough()) continue;
    const Coat& coat = cases[i].coat;
    const double two = two_fluxes(coat), all = all_that_leaves(*build<Bsdf>(layered(coat)));
    std::printf("%-28s layered %.4f, paint %.4f (%+.4f)\n", coat.name, all, two, two - all);
    EXPECT_NEAR(two - all, cases[i].paint_is_off, 0.001) << coat.name;
  }
}

}  // namespace
}  // namespace aureole::testing
