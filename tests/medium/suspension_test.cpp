// SPDX-License-Identifier: Apache-2.0
// Media by what is in them: coefficients against published values and closed forms, units, notes, bad input.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "aureole/instrument/medium_figures.h"
#include "aureole/medium/medium.h"
#include "aureole/optics/medium/recipes.h"
#include "loading/load_text.h"
#include "volume/volume_test_support.h"

namespace aureole::test {
namespace {

using testing::build;

/// A range around 550 nm: tables of few wavelengths are made in little time.
std::shared_ptr<const BuildContext> context(double length_unit_m = 1, Diagnostics* diagnostics = nullptr) {
  auto c = std::make_shared<BuildContext>(*testing::make_context(540, 560, diagnostics));
  c->length_unit_m = length_unit_m;
  return c;
}

std::string medium_xml(const std::string& type, const std::string& parameters) {
  return "<medium type=\"" + type + "\">" + parameters + "</medium>";
}
std::string number(const std::string& name, double value) {
  char text[64];
  std::snprintf(text, sizeof text, "%.9g", value);
  return "<float name=\"" + name + "\" value=\"" + text + "\"/>";
}
MediumPtr suspension(const std::string& parameters, double length_unit_m = 1) {
  return build<Medium>(medium_xml("suspension", parameters), context(length_unit_m));
}

struct Coefficients {
  double t, s;
  double a() const { return t - s; }
};
/// In units of the scene.
Coefficients at(const Medium& m, double nm = 550, const Vec3& p = {}) {
  MediumCoefficients c;
  m.eval(p, {0, 0, 1}, Wavelengths::at(m.properties().context().grid, float(nm)), c);
  return {double(c.sigma_t[0]), double(c.sigma_s[0])};
}

const std::string kSkim = choice("recipe", "skim_milk");

TEST(SuspensionMedium, FatOfSkimMilk) {
  // 258 /m at 550 nm (Frisvad, Christensen & Jensen 2007).
  const MediumPtr fat = suspension(kSkim + number("protein", 0));
  EXPECT_NEAR(at(*fat).s, 258, 0.03 * 258);
  // It scatters in proportion to its amount, where sizes stay.
  const auto spheres = [&](double fraction, double unit) {
    return at(*suspension("<ingredient type=\"spheres\">" + choice("radius", "0.2um") +
                              number("size_spread", 0.3) + number("int_ior", 1.46) +
                              number("volume_fraction", fraction) + "</ingredient>",
                          unit));
  };
  const double water = at(*suspension(choice("recipe", "water"))).s;
  const Coefficients thin = spheres(1e-3, 1), thick = spheres(2e-3, 1), in_mm = spheres(1e-3, 1e-3);
  EXPECT_NEAR((thick.s - water) / (thin.s - water), 2, 1e-3);
  EXPECT_NEAR(in_mm.s / thin.s, 1e-3, 1e-8);
  EXPECT_NEAR(in_mm.t / thin.t, 1e-3, 1e-8);
}

TEST(SuspensionMedium, SmallSpheresFollowRayleigh) {
  const double radius = 5e-9, n = 1.6, density = 1e18;
  const MediumPtr m =
      suspension(number("host", 1.3) + "<ingredient type=\"spheres\">" + choice("radius", "5nm") +
                 number("int_ior", n) + number("number_density", density) + "</ingredient>");
  const double k = 2 * M_PI * 1.3 / 550e-9, ratio = n / 1.3;
  const double l = (ratio * ratio - 1) / (ratio * ratio + 2);
  EXPECT_NEAR(at(*m).s / (density * 8 * M_PI / 3 * std::pow(k, 4) * std::pow(radius, 6) * l * l), 1, 0.01);
  const double nm[] = {550};
  EXPECT_NEAR(measure_medium(*m, nm, {}, {0, 0, 1})[0].asymmetry, 0, 0.01);
}

TEST(SuspensionMedium, CoatedSpheresAreThoseOfBohrenAndHuffman) {
  // The sample run of program BHCOAT (Absorption and Scattering of Light by Small Particles, 1983, appendix B): radii
  // .171 and 6.265 um, 3 um, Qext = 2.32803, Qsca = 1.14341, and g = .94340 of the same spheres by scattnlay.
  auto infrared = std::make_shared<BuildContext>(*testing::make_context(2990, 3010));
  const auto coated = [&](const std::string& core) {
    return build<Medium>(
        medium_xml("suspension", choice("host", "vacuum") + "<ingredient type=\"coated_spheres\">" +
                                     choice("radius", "6.265um") + core + number("int_ior", 1.59) +
                                     number("k", 0.66) + number("coat_ior", 1.409) +
                                     number("coat_k", 0.1747) + number("number_density", 1e9) +
                                     "</ingredient>"),
        infrared);
  };
  const double shadows = 1e9 * M_PI * 6.265e-6 * 6.265e-6;
  for (const auto& m :
       {coated(number("core_fraction", 0.171 / 6.265)), coated(choice("coat_thickness", "6.094um"))}) {
    EXPECT_NEAR(at(*m, 3000).t / shadows, 2.32803, 1e-4);
    EXPECT_NEAR(at(*m, 3000).s / shadows, 1.14341, 1e-4);
    const double nm[] = {3000};
    EXPECT_NEAR(measure_medium(*m, nm, {}, {0, 0, 1})[0].asymmetry, 0.94340, 1e-3);
  }
  // Where the coat is thicker than the sphere there is no core.
  const MediumPtr plain = build<Medium>(
      medium_xml("suspension", choice("host", "vacuum") + "<ingredient type=\"spheres\">" +
                                   choice("radius", "6.265um") + number("int_ior", 1.409) +
                                   number("k", 0.1747) + number("number_density", 1e9) + "</ingredient>"),
      infrared);
  EXPECT_NEAR(at(*coated(choice("coat_thickness", "7um")), 3000).t / at(*plain, 3000).t, 1, 1e-6);
}

TEST(SuspensionMedium, PureWater) {
  const MediumPtr m = suspension(choice("recipe", "water"));
  EXPECT_NEAR(at(*m).a(), 0.0565, 1e-4);           // Pope & Fry 1997
  EXPECT_NEAR(at(*m).s, 16.06 * 0.93e-4, 0.5e-5);  // Morel 1974
}

TEST(SuspensionMedium, BetweenTabulatedWavelengths) {
  // Soot is tabulated at a dozen wavelengths from 360 to 830 nm, here at each alone.
  const auto smoke = build<Medium>(medium_xml("suspension", choice("recipe", "smoke")));
  for (const double nm : {371.0, 433.0, 487.0, 555.0, 634.0, 702.0, 817.0}) {
    const auto c = optics::smoke(1e-3).spectrum({nm}, false).coefficients[0];
    EXPECT_NEAR(at(*smoke, nm).t / c.extinction(), 1, 5e-3) << nm;
    EXPECT_NEAR(at(*smoke, nm).s / c.scattering, 1, 5e-3) << nm;
  }
}

TEST(SuspensionMedium, MassFractionsNeedDensities) {
  const auto with = [](const std::string& amount) {
    return suspension(number("host", 1.5) + number("host_density", 900) + "<ingredient type=\"spheres\">" +
                      choice("radius", "50nm") + number("int_ior", 1.6) + number("density", 1800) + amount +
                      "</ingredient>");
  };
  // A tenth of the mass at twice the density: f = (0.1/1800)/(0.1/1800 + 0.9/900) of the volume.
  const double fraction = 0.1 / 1800 / (0.1 / 1800 + 0.9 / 900);
  EXPECT_NEAR(at(*with(number("mass_fraction", 0.1))).s / at(*with(number("volume_fraction", fraction))).s, 1,
              1e-5);
}

TEST(SuspensionMedium, DensityOfAGrid) {
  VolumeFolder folder;
  std::string grid =
      grid_xml(write_bytes(folder.path() / "d.vol", make_vol({2, 1, 1}, 1, {0.f, 0.5f}).bytes()),
               choice("filter_type", "nearest"));
  grid.insert(grid.find(" type="), " name=\"density\"");
  const std::string smoke = choice("recipe", "smoke");
  const MediumPtr whole = suspension(smoke), cloud = suspension(smoke + grid);
  ASSERT_TRUE(cloud->majorants());
  EXPECT_FALSE(cloud->is_uniform());
  EXPECT_TRUE(whole->is_uniform());
  EXPECT_EQ(at(*cloud, 550, {0.2f, 0.5f, 0.5f}).t, 0);
  EXPECT_NEAR(at(*cloud, 550, {0.8f, 0.5f, 0.5f}).t / at(*whole).t, 0.5, 1e-6);
  const Spectrum bound = cloud->majorant({0, 0, 1}, Wavelengths::at(context()->grid, 550));
  EXPECT_GE(double(bound[0]) * double(cloud->majorants().max_bound()), 0.5 * at(*whole).t * (1 - 1e-6));
}

TEST(SolutionMedium, DyesAddToTheirSolvent) {
  const auto solution = [](const std::string& parameters, double unit = 1) {
    return build<Medium>(medium_xml("solution", parameters), context(unit));
  };
  const std::string vacuum = choice("solvent", "vacuum");
  const std::string one = "<ingredient type=\"dye\">" + number("absorbance_1cm", 0.7) + "</ingredient>";
  const std::string two = "<ingredient type=\"dye\">" + number("molar_absorptivity", 30000) +
                          number("concentration", 2e-5) + "</ingredient>";
  // 10^-A of 1 cm, A = 30000 x 2e-5 = 0.6 of the second.
  const auto passed = [](const Medium& m, double cm_per_unit) { return std::exp(-at(m).t / cm_per_unit); };
  EXPECT_NEAR(passed(*solution(vacuum + one), 100), std::pow(10, -0.7), 1e-5);
  EXPECT_NEAR(passed(*solution(vacuum + one + two), 100), std::pow(10, -1.3), 1e-5);
  EXPECT_NEAR(passed(*solution(vacuum + one, 0.01), 1), std::pow(10, -0.7), 1e-5);
  EXPECT_EQ(at(*solution(vacuum + one)).s, 0);
  EXPECT_NEAR(at(*solution(one)).a() - at(*solution(vacuum + one)).a(), 0.0565, 1e-3);
}

TEST(SuspensionMedium, NotesWhatDependentScatteringWouldChange) {
  const auto notes = [](const std::string& parameters) {
    Diagnostics diagnostics;
    build<Medium>(medium_xml("suspension", parameters), context(1, &diagnostics));
    return diagnostics.notes();
  };
  // Casein fills some 2 % of milk; its scattering falls by 12 %.
  const auto off = notes(kSkim);
  ASSERT_EQ(off.size(), 1u);
  EXPECT_NE(off[0].find("casein"), std::string::npos) << off[0];
  EXPECT_NE(off[0].find("-12"), std::string::npos) << off[0];
  EXPECT_TRUE(notes(kSkim + "<boolean name=\"dependent_scattering\" value=\"true\"/>").empty());
  EXPECT_TRUE(notes(choice("recipe", "smoke")).empty());
  // The recipe corrects casein, not the fat, which a note must not promise.
  const auto fat =
      notes(choice("recipe", "milk") + "<boolean name=\"dependent_scattering\" value=\"true\"/>");
  ASSERT_EQ(fat.size(), 1u);
  EXPECT_NE(fat[0].find("milk fat"), std::string::npos) << fat[0];
  EXPECT_NE(fat[0].find("the recipe does not count it"), std::string::npos) << fat[0];
}

/// Scattering figures of spheres of the index 1.5 in a host of 1.33, at 550 nm.
struct SphereFigures {
  MediumFigures figures;
  std::vector<double> phase;  ///< at 0, 20, 90 and 160 degrees
};
SphereFigures figures_of_spheres(const std::string& parameters) {
  const MediumPtr m = suspension(number("host", 1.33) + "<ingredient type=\"spheres\">" + parameters +
                                 number("int_ior", 1.5) + "</ingredient>");
  const double nm[] = {550}, angles[] = {0, 20 * M_PI / 180, M_PI / 2, 160 * M_PI / 180};
  return {measure_medium(*m, nm, {}, {0, 0, 1})[0], phase_over_angle(*m, 550, angles, {}, {0, 0, 1})};
}
std::string list(const std::string& name, const std::vector<double>& numbers) {
  std::string text;
  char word[64];
  for (const double n : numbers) std::snprintf(word, sizeof word, "%.12g, ", n), text += word;
  return choice(name, text);
}
std::string histogram(const std::string& weighting, const std::string& quantity = "radius",
                      const std::string& unit = "um") {
  return choice("distribution", "histogram") + choice("weighting", weighting) + choice("size_unit", unit) +
         choice("size_quantity", quantity);
}
void expect_same(const SphereFigures& a, const SphereFigures& b, double tolerance, double phase_tolerance) {
  double phase = 0;
  for (std::size_t i = 0; i < a.phase.size(); ++i)
    phase = std::max(phase, std::abs(a.phase[i] / b.phase[i] - 1));
  std::printf("differences: sigma_s %.1e, g %.1e, phase function %.1e\n",
              a.figures.scattering / b.figures.scattering - 1, a.figures.asymmetry - b.figures.asymmetry,
              phase);
  EXPECT_NEAR(a.figures.scattering / b.figures.scattering, 1, tolerance);
  EXPECT_NEAR(a.figures.asymmetry, b.figures.asymmetry, tolerance);
  EXPECT_LT(phase, phase_tolerance);
}

TEST(SuspensionMedium, FineHistogramsAreTheirDistribution) {
  const double median = 1, sigma = 0.3;
  const std::string amount = number("volume_fraction", 1e-3);
  for (const char* weighting : {"number", "volume"}) {
    std::vector<double> edges, weights, middles;
    constexpr int kClasses = 100;
    const auto below = [&](double r) {
      return 0.5 * std::erfc(-std::log(r / median) / sigma / std::sqrt(2.0));
    };
    for (int i = 0; i <= kClasses; ++i) edges.push_back(median * std::exp(sigma * (10.0 * i / kClasses - 5)));
    for (std::size_t i = 0; i < kClasses; ++i)
      weights.push_back(below(edges[i + 1]) - below(edges[i])),
          middles.push_back(std::sqrt(edges[i] * edges[i + 1]));
    const SphereFigures exact = figures_of_spheres(choice("radius", "1um") + number("size_spread", sigma) +
                                                   choice("weighting", weighting) + amount);
    expect_same(figures_of_spheres(histogram(weighting) + choice("classes", "edges") + list("sizes", edges) +
                                   list("weights", weights) + amount),
                exact, 1e-3, 5e-3);
    // Diameters in nanometres of the middles of the classes are as good.
    for (double& m : middles) m *= 2000;
    expect_same(figures_of_spheres(histogram(weighting, "diameter", "nm") + list("sizes", middles) +
                                   list("weights", weights) + amount),
                exact, 1e-3, 5e-3);
  }
}

TEST(SuspensionMedium, HistogramsOfNarrowClasses) {
  const SphereFigures one = figures_of_spheres(choice("radius", "1um") + number("volume_fraction", 1e-3));
  const auto narrow = [](const std::string& weighting) {
    return histogram(weighting) + choice("classes", "edges");
  };
  for (const char* weighting : {"number", "volume"}) {
    expect_same(figures_of_spheres(narrow(weighting) + list("sizes", {0.999, 1.001}) + list("weights", {7}) +
                                   number("volume_fraction", 1e-3)),
                one, 1e-3, 2e-3);
    expect_same(figures_of_spheres(histogram(weighting) + list("sizes", {1}) + list("weights", {7}) +
                                   number("volume_fraction", 1e-3)),
                one, 1e-6, 1e-6);
  }
  // Three spheres of 1 um for one of 2 um: by number 3 and 1, by volume 3 and 8. Each size scatters as if alone.
  const auto alone = [](const char* radius, double density) {
    return figures_of_spheres(choice("radius", radius) + number("number_density", density))
        .figures.scattering;
  };
  const double host = alone("1um", 0), sum = alone("1um", 3e14) + alone("2um", 1e14) - host;
  const std::string sizes = list("sizes", {0.999, 1.001, 1.998, 2.002}),
                    amount = number("number_density", 4e14);
  const SphereFigures by_number =
                          figures_of_spheres(narrow("number") + sizes + list("weights", {3, 0, 1}) + amount),
                      by_volume =
                          figures_of_spheres(narrow("volume") + sizes + list("weights", {3, 0, 8}) + amount);
  EXPECT_NEAR(by_number.figures.scattering / sum, 1, 1e-3);
  EXPECT_NEAR(by_volume.figures.scattering / sum, 1, 1e-3);
  expect_same(by_number, by_volume, 1e-3, 1e-3);
}

TEST(SuspensionMedium, HistogramsOfFiles) {
  test::TemporaryFolder folder;
  const std::string amount = number("volume_fraction", 1e-3);
  folder.write("sizes.csv",
               "diameter in um, volume in %\n# of an instrument\n1.6, 30\n2.0, 50\n2.5, 20\n3.0, 0\n");
  const std::string file = choice("size_histogram", (folder.path / "sizes.csv").string());
  expect_same(
      figures_of_spheres(histogram("volume", "diameter") + file + choice("classes", "edges") + amount),
      figures_of_spheres(histogram("volume") + choice("classes", "edges") +
                         list("sizes", {0.8, 1, 1.25, 1.5}) + list("weights", {3, 5, 2}) + amount),
      1e-6, 1e-6);
  expect_same(figures_of_spheres(histogram("volume", "diameter") + file + amount),
              figures_of_spheres(histogram("volume") + list("sizes", {0.8, 1, 1.25, 1.5}) +
                                 list("weights", {3, 5, 2, 0}) + amount),
              1e-6, 1e-6);
}

// The first class is empty in double precision: the other is all there is.
TEST(SuspensionMedium, HistogramsWithNextToNothingInAClass) {
  const auto figures = [](const std::string& sizes, const std::string& weights) {
    return figures_of_spheres(histogram("number") + choice("classes", "edges") + choice("sizes", sizes) +
                              choice("weights", weights) + number("volume_fraction", 1e-3));
  };
  expect_same(figures("1, 1.01, 1.02", "1e-300, 1e29"), figures("1.01, 1.02", "1"), 1e-9, 1e-9);
}

TEST(SuspensionMedium, HistogramsRefuseWrongInput) {
  test::TemporaryFolder folder;
  const auto fails = [&](const std::string& parameters, const std::string& text) {
    const std::string e = error_thrown_by([&] {
      build<Medium>(medium_xml("suspension", number("host", 1.33) + "<ingredient type=\"spheres\">" +
                                                 parameters + number("int_ior", 1.5) +
                                                 number("volume_fraction", 1e-3) + "</ingredient>"),
                    context());
    });
    EXPECT_NE(e.find(text), std::string::npos) << "expected \"" << text << "\", got: " << e;
    EXPECT_NE(e.find(":"), std::string::npos) << "no location: " << e;
  };
  const std::string start = histogram("number");
  const auto both = [&](const std::string& sizes, const std::string& weights, const std::string& more = "") {
    return start + choice("sizes", sizes) + choice("weights", weights) + more;
  };
  const std::string edges = choice("classes", "edges");
  fails(start, "needs \"sizes\" and \"weights\", or the file");
  fails(both("", ""), "has no class");
  fails(both("1", "", edges), "has no class");
  fails(both("1, 2", "3"), "2 midpoints do not go with 1 weights");
  fails(both("1, 2", "3, 4", edges), "2 edges do not go with 2 weights");
  fails(both("1, -2", "3, 4"), "a size must be positive, got -2");
  fails(both("0, 2", "3", edges), "a size must be positive, got 0");
  fails(both("2, 1", "3, 4"), "sizes must increase, at the size 1");
  fails(both("1, 1", "3, 4"), "sizes must increase");
  fails(both("1, 2", "3, -4"), "a weight must not be negative, got -4, at the size 2");
  fails(both("1, nan", "3, 4"), "not a number");
  fails(both("1, 2", "nan, 4"), "not a number");
  fails(both("1, 2um", "3, 4"), "not a number");
  fails(both("1, 2", "0, 0"), "all weights are 0");
  fails(both("1, 2", "3, 4", choice("radius", "1um")), "has no meaning for the distribution \"histogram\"");
  fails(both("1, 2", "3, 4", number("size_spread", 0.1)), "has no meaning");
  fails(choice("radius", "1um") + choice("sizes", "1, 2"),
        "has no meaning for the distribution \"log_normal\"");
  const std::string lists = choice("sizes", "1") + choice("weights", "1"),
                    kind = choice("distribution", "histogram");
  fails(kind + lists + choice("size_unit", "um") + choice("size_quantity", "radius"),
        "a histogram needs \"weighting\"");
  fails(kind + lists + choice("size_unit", "um") + choice("weighting", "volume"),
        "a histogram needs \"size_quantity\"");
  fails(kind + lists + choice("size_quantity", "radius") + choice("weighting", "volume"),
        "a histogram needs \"size_unit\"");
  fails(kind + lists + choice("size_quantity", "radius") + choice("weighting", "volume") +
            choice("size_unit", "furlong"),
        "not a unit of length");
  fails(kind + lists + choice("size_quantity", "radius") + choice("weighting", "volume") +
            choice("size_unit", "2um"),
        "not a unit of length");
  const auto of_file = [&](const std::string& text) {
    folder.write("sizes.csv", text);
    return start + choice("size_histogram", (folder.path / "sizes.csv").string());
  };
  fails(of_file(""), "has no class");
  fails(of_file("1 2\n3 x\n"), "line 2: expected two numbers");
  fails(of_file("1 2\n0.5 3\n"), "sizes must increase, at the size 0.5");
  fails(of_file("1 2\n2 nan\n"), "line 2: expected two numbers");
  fails(of_file("1 2\n2 3\n") + edges, "the last weight is 3");
  fails(of_file("1 2\n") + lists, "not both");
}

TEST(SuspensionMedium, RefusesWrongInput) {
  const auto expect_error = [](const std::string& parameters, const std::string& text,
                               const std::string& type = "suspension") {
    const std::string e = error_thrown_by([&] { build<Medium>(medium_xml(type, parameters), context()); });
    EXPECT_NE(e.find(text), std::string::npos) << "expected \"" << text << "\", got: " << e;
  };
  const auto spheres = [](const std::string& parameters) {
    return "<ingredient type=\"spheres\">" + choice("radius", "1um") + number("int_ior", 1.5) + parameters +
           "</ingredient>";
  };
  expect_error("", "needs a \"recipe\"");
  expect_error(choice("recipe", "milkk"), "milk");
  expect_error(choice("recipe", "milk") + number("fat", 60), "[0, 40]");
  expect_error(choice("recipe", "smoke") + number("fat", 1), "no meaning");
  expect_error(choice("recipe", "milk") + choice("host", "water"), "no meaning");
  expect_error(number("number_density", 1e9) + spheres(number("volume_fraction", 0.1)), "recipe");
  expect_error(spheres(""), "needs one of");
  expect_error(spheres(number("volume_fraction", 0.1) + number("mass_fraction", 0.1)), "either");
  expect_error(spheres(number("volume_fraction", 0.8)), "more particles than fit");
  expect_error(spheres(number("volume_fraction", 0.5)) + spheres(number("volume_fraction", 0.5)),
               "more particles than fit");
  expect_error(spheres(number("volume_fraction", -0.1)), "[0, 1]");
  expect_error(spheres(number("mass_fraction", 0.1)), "density");
  expect_error(number("host", 1.4) + spheres(number("mass_fraction", 0.1) + number("density", 1000)),
               "density of the medium");
  const auto coated = [](const std::string& parameters) {
    return "<ingredient type=\"coated_spheres\">" + choice("radius", "1um") + number("volume_fraction", 0.1) +
           parameters + "</ingredient>";
  };
  const std::string indices = number("int_ior", 1.5) + number("coat_ior", 1.4);
  expect_error(coated(number("int_ior", 1.5)), "\"coat_ior\" is required");
  expect_error(coated(indices), "either \"core_fraction\" or \"coat_thickness\"");
  expect_error(coated(indices + number("core_fraction", 0.5) + choice("coat_thickness", "1um")), "either");
  expect_error(coated(indices + number("core_fraction", 1.5)), "(0, 1)");
  expect_error(coated(choice("int_ior", "Au") + number("coat_ior", 1.4) + number("k", 1) +
                      number("core_fraction", 0.5)),
               "leave \"k\" out");
  expect_error(choice("host", "watre") + spheres(number("volume_fraction", 0.1)), "water");
  expect_error(spheres(number("volume_fraction", 0.1)), "a solution holds dyes", "solution");
  expect_error("<ingredient type=\"dye\">" + number("molar_absorptivity", 1) + "</ingredient>",
               "\"concentration\" is required", "solution");
  expect_error("<ingredient type=\"dye\">" + number("absorbance_1cm", 1) + number("concentration", 1) +
                   "</ingredient>",
               "no concentration", "solution");
  expect_error("<ingredient type=\"dye\">" + number("absorbance_1cm", -1) + "</ingredient>", "negative",
               "solution");
}

}  // namespace
}  // namespace aureole::test
