// SPDX-License-Identifier: Apache-2.0
// Illuminants, observers and figures of the trade against published tables and other programs.
#include "aureole/instrument/paint/colour_figures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "aureole/core/error.h"
#include "aureole/instrument/paint/two_flux_doubt.h"
#include "loading/load_text.h"

namespace aureole::test {
namespace {

struct Curves {
  std::vector<double> nm, standard, sample, white;

  /// The reflectances of tests/references/colour_figures.py.
  Curves() {
    const auto edge = [](double l, double at, double width) { return 1 / (1 + std::exp(-(l - at) / width)); };
    const auto bell = [](double l, double at, double width) {
      return std::exp(-std::pow((l - at) / width, 2));
    };
    for (double l = 360; l <= 830; ++l) {
      nm.push_back(l);
      standard.push_back(0.05 + 0.8 * edge(l, 585, 22) + 0.12 * bell(l, 440, 40));
      sample.push_back(0.06 + 0.76 * edge(l, 588, 15) + 0.15 * bell(l, 430, 30));
      white.push_back(0.88 - 0.35 * std::exp(-(l - 360) / 18));
    }
  }
};

/// White points X_n, Z_n for Y_n = 100: CIE 15:2004, table T.3, and of the fluorescent lamps ASTM E308-18, table 5.
/// They were summed every 5 nm and with fewer digits: up to 0.11 from sums every nanometre.
TEST(ColourFigures, WhitePointsOfBothObservers) {
  struct White {
    const char* viewing;
    double x, z;
  };
  for (const White& w : {White{"A", 109.85, 35.58},
                         {"C", 98.07, 118.22},
                         {"D50", 96.42, 82.51},
                         {"D55", 95.68, 92.14},
                         {"D65", 95.04, 108.88},
                         {"D75", 94.97, 122.61},
                         {"E", 100, 100},
                         {"A/10", 111.14, 35.20},
                         {"C/10", 97.29, 116.14},
                         {"D50/10", 96.72, 81.43},
                         {"D55/10", 95.80, 90.93},
                         {"D65/10", 94.81, 107.32},
                         {"D75/10", 94.42, 120.64},
                         {"E/10", 100, 100},
                         {"F2/2", 99.19, 67.39},
                         {"F2/10", 103.28, 69.03},
                         {"F7/10", 95.79, 107.69},
                         {"F11", 100.96, 64.37},
                         {"F11/10", 103.86, 65.61}}) {
    const std::vector<double> nm{360, 830};
    const pigment::Xyz white = observe(w.viewing, nm).white();
    EXPECT_NEAR(100 * white[0], w.x, 0.12) << w.viewing;
    EXPECT_NEAR(100 * white[2], w.z, 0.12) << w.viewing;
  }
}

/// Numbers by tests/references/colour_figures.py, whose tables of daylight end at 780 nm: that is up to 3e-4 in L*, a*, b*.
TEST(ColourFigures, AgreeWithAnotherProgram) {
  const Curves c;
  struct Reference {
    const char* viewing;
    pigment::Lab standard, sample;
    double metamerism;
  };
  ColourSettings settings{.viewing = "D65/10"};
  const Reference references[] = {
      {"D65/2", {61.530039, 46.021239, 29.352610}, {57.989865, 55.527739, 24.280278}, 1.128685},
      {"D65/10", {60.406944, 45.610926, 26.971206}, {56.956341, 54.126309, 21.282373}, 0},
      {"A/10", {67.315390, 43.870123, 40.173745}, {64.677278, 50.470352, 37.211107}, 4.643473},
      {"C", {61.895896, 43.720280, 29.726758}, {58.355062, 53.285270, 24.333167}, 0.947963},
      {"F11/10", {63.802258, 42.712687, 31.113900}, {60.833826, 52.266926, 24.291029}, 1.175383},
      {"LED-B3/10", {64.010727, 40.099764, 31.290892}, {60.798132, 47.407833, 26.848141}, 2.432032},
      {"D50", {62.995828, 48.229832, 32.275188}, {59.652168, 57.173987, 28.114670}, 1.774129}};
  for (const Reference& r : references) settings.others.emplace_back(r.viewing);
  settings.strength.white = c.white;
  const ColourComparison all = compare_colours(c.nm, c.standard, c.sample, settings);
  for (std::size_t i = 0; i < std::size(references); ++i) {
    const Reference& r = references[i];
    for (const auto& [values, lab] : {std::pair{c.standard, r.standard}, {c.sample, r.sample}}) {
      const ColourFigures f = colour_figures(c.nm, values, r.viewing);
      EXPECT_NEAR(f.lab.l, lab.l, 4e-4) << r.viewing;
      EXPECT_NEAR(f.lab.a, lab.a, 4e-4) << r.viewing;
      EXPECT_NEAR(f.lab.b, lab.b, 4e-4) << r.viewing;
    }
    EXPECT_NEAR(all.metamerism[i], r.metamerism, 4e-4) << r.viewing;
  }
  ASSERT_TRUE(all.strength);
  EXPECT_EQ(all.strength->nm, 502);
  EXPECT_NEAR(all.strength->at_maximum, 1.297001, 1e-6);
  EXPECT_NEAR(all.strength->summed, 1.295525, 1e-6);
  EXPECT_NEAR(all.strength->weighted, 1.324386, 1e-6);
  EXPECT_NEAR(all.tone_ciede2000, 5.971391, 1e-4);

  struct White {
    const char* viewing;
    double whiteness, tint, yellowness;
  };
  for (const White& w : {White{"D65", 86.852352, 0.092905, 0.381224},
                         {"D65/10", 86.708641, 0.115557, 0.435578},
                         {"C", 0, 0, 0.421094},
                         {"C/10", 0, 0, 0.476960}}) {
    const ColourFigures f = colour_figures(c.nm, c.white, w.viewing);
    EXPECT_EQ(f.whiteness.has_value(), w.whiteness > 0);
    if (f.whiteness) {
      EXPECT_NEAR(f.whiteness->whiteness, w.whiteness, 1e-4);
      EXPECT_NEAR(f.whiteness->tint, w.tint, 1e-4);
      EXPECT_TRUE(f.whiteness->is_valid);
    }
    EXPECT_NEAR(f.yellowness.value(), w.yellowness, 1e-3);
  }
  EXPECT_FALSE(colour_figures(c.nm, c.standard, "D65").whiteness->is_valid);
  EXPECT_FALSE(colour_figures(c.nm, c.white, "A").yellowness);
}

/// Reflectances every 10 nm from 400 to 700 nm: by the tables of ASTM E308 (colour-science,
/// tests/references/colour_figures.py). Straight lines between them would be off by 0.06.
TEST(ColourFigures, EveryTenNanometres) {
  const Curves c;
  std::vector<double> nm, values;
  for (std::size_t i = 0; i < c.nm.size(); ++i)
    if (c.nm[i] >= 400 && c.nm[i] <= 700 && std::fmod(c.nm[i], 10) == 0)
      nm.push_back(c.nm[i]), values.push_back(c.standard[i]);
  for (const auto& [viewing, lab] :
       {std::pair<const char*, pigment::Lab>{"D65/10", {60.4074, 45.6064, 26.9763}},
        {"A", {67.8555, 46.1165, 41.6535}},
        {"F11/10", {63.8022, 42.7062, 31.1266}}})
    EXPECT_LT(pigment::cie1976(colour_figures(nm, values, viewing).lab, lab), 0.02) << viewing;
}

/// docs/pigments.md, "Limits": with an index of 1, albedo 0.9, thickness 1 in 1/(sigma_s (1 - g)) and over black, two fluxes
/// are off by -0.8 L* from 67.1 for g = 0, which is a CIEDE2000 of 0.65; other g are off by somewhat more. A thick white is
/// off by nothing, and a layer a tenth as thick by -2.9 L* from 34.3.
TEST(ColourFigures, DoubtOfTwoFluxes) {
  const std::vector<double> nm{400, 450, 500, 550, 600, 650, 700};
  const pigment::Observation lamp = observe("D65", nm);
  // K = 2 sigma_a, S = 3/4 sigma_s (1 - g), with sigma_s = 1 and sigma_a = 1/9.
  const pigment::Paint grey(nm.size(), {2. / 9, 0.75}), white(nm.size(), {0, 0.75});
  EXPECT_GT(two_flux_doubt(grey, nm, 1, 0, 1, lamp), 0.6);
  EXPECT_LT(two_flux_doubt(grey, nm, 1, 0, 1, lamp), 1);
  EXPECT_LT(two_flux_doubt(white, nm, 1000, 0, 1, lamp), 0.1);
  EXPECT_GT(two_flux_doubt(grey, nm, 0.1, 0, 1, lamp), 2);
}

/// A cubic comes back exactly from steps up to 20 nm; wider steps are bridged by straight lines, and ends are constant.
TEST(ColourFigures, ReflectancesBetweenTheirWavelengths) {
  const auto cubic = [](double l) {
    return 0.4 + 0.2 * std::pow((l - 540) / 150, 3) - 0.1 * (l - 560) / 150;
  };
  const auto sampled = [&](double step) {
    MeasuredReflectance m;
    for (double l = 400; l <= 700; l += step) m.nm.push_back(l), m.values.push_back(cubic(l));
    return m;
  };
  const std::vector<double> at{390, 400, 403, 517, 560, 699, 720};
  const std::vector<double> fine = sampled(20).at(at), wide = sampled(50).at(at);
  EXPECT_DOUBLE_EQ(fine.front(), cubic(400));
  EXPECT_DOUBLE_EQ(fine.back(), cubic(700));
  for (std::size_t i = 1; i + 1 < at.size(); ++i) EXPECT_NEAR(fine[i], cubic(at[i]), 1e-12) << at[i];
  EXPECT_NEAR(wide[3], cubic(500) + 17. / 50 * (cubic(550) - cubic(500)), 1e-12);
}

TEST(ColourFigures, NamesOfIlluminantsInAnyCase) {
  EXPECT_EQ(viewing_of("d65/10").illuminant, "D65");
  EXPECT_EQ(viewed_at("led-b3", "10"), "LED-B3/10");
  const std::vector<double> nm{400, 700}, grey{0.9, 0.9};
  EXPECT_TRUE(colour_figures(nm, grey, "d65").whiteness && colour_figures(nm, grey, "c").yellowness);
}

TEST(ColourFigures, LampsFromFiles) {
  const TemporaryFolder folder;
  const auto file = [&](const std::string& name, const std::string& text) {
    std::ofstream(folder.path / name) << text;
    return (folder.path / name).string();
  };
  const std::vector<double> nm{360, 830};
  // A lamp of equal power is illuminant E.
  const std::string flat = file("lamp.csv", "wavelength,power\n360,2\n830,2\n");
  for (const char* degrees : {"2", "10"}) {
    const pigment::Xyz a = observe(viewed_at(flat, degrees), nm).white(),
                       b = observe(viewed_at("E", degrees), nm).white();
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], 1e-12);
  }
  EXPECT_EQ(viewed_at("A/2", "10"), "A/2");
  EXPECT_EQ(viewed_at("A", "2"), "A");
  const auto message = [&](const std::string& name) -> std::string {
    try {
      observe(name, nm);
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_NE(message("D66/10").find("unknown illuminant \"D66\""), std::string::npos);
  EXPECT_NE(message("D66").find("there is no file of that name"), std::string::npos);
  EXPECT_NE(message(file("short.csv", "450,1\n500,1\n")).find("at least from 420 to 680 nm"),
            std::string::npos);
  EXPECT_NE(message(file("dark.csv", "400,1\n500,-1\n700,1\n")).find("the power at 500 nm is negative"),
            std::string::npos);
}

}  // namespace
}  // namespace aureole::test
