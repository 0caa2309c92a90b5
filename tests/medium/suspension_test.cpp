// SPDX-License-Identifier: Apache-2.0
// Media by what is in them: coefficients against published values and closed forms, units, notes, bad input.
#include <gtest/gtest.h>

#include <cmath>

#include "aureole/instrument/medium_figures.h"
#include "aureole/medium/medium.h"
#include "aureole/optics/medium/recipes.h"
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

TEST(SuspensionMedium, RefusesWrongInput) {
  const auto expect_error = [](const std::string& parameters, const std::string& text,
                               const std::string& type = "suspension") {
    const std::string e = error_of([&] { build<Medium>(medium_xml(type, parameters), context()); });
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
