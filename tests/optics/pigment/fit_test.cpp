// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "aureole/pigment/cgats_text.h"
#include "aureole/pigment/measured_paints.h"
#include "aureole/pigment/palette_text.h"
#include "aureole/pigment/prediction.h"

namespace aureole::pigment {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

SampleTable table_of(const std::string& text) {
  std::istringstream stream(text);
  return read_samples(stream);
}

/// Two paints, per metre, and what an instrument would measure of them, to 12 digits.
struct Laboratory {
  Palette palette{.nm = {450, 550, 650},
                  .pigments = {{.name = "white", .k = {300, 150, 100}, .s = {90000, 80000, 70000}},
                               {.name = "red", .k = {80000, 60000, 900}, .s = {20000, 25000, 30000}}},
                  .relative = false,
                  .surface = smooth_surface(1.5, Geometry::diffuse_8, Specular::included)};

  Sample sample(const std::string& recipe, const std::string& backing, double thickness = 0,
                bool through = false) const {
    Sample s;
    s.name = recipe, s.paints = parse_recipe(recipe);
    s.quantity = through ? Sample::Quantity::transmittance : Sample::Quantity::reflectance;
    s.backing = backing, s.thickness = thickness;
    s.values = predict(palette, {}, s);
    return s;
  }
  void expect(const Fit& fit, bool relative) const {
    EXPECT_EQ(fit.palette.relative, relative);
    for (const Pigment& found : fit.palette.pigments) {
      const Pigment& truth = palette.pigments[*palette.find(found.name)];
      for (std::size_t i = 0; i < 3; ++i) {
        const double unit = relative ? palette.pigments[0].s[i] : 1;
        EXPECT_NEAR(found.k[i] * unit / truth.k[i], 1, 1e-9) << found.name;
        EXPECT_NEAR(found.s[i] * unit / truth.s[i], 1, 1e-9) << found.name;
      }
    }
  }
};

TEST(PigmentFit, EveryMethodComesBack) {
  const Laboratory lab;
  const Sample white = lab.sample("white", "opaque"), red = lab.sample("red", "opaque");
  const Sample tint = lab.sample("red: 10% + white: 90%", "opaque"),
               deep = lab.sample("red: 1 + white: 1", "opaque");
  lab.expect(fit({lab.palette.nm, {white, red, tint}}, {.surface = lab.palette.surface}), true);
  const Fit ladder = fit({lab.palette.nm, {white, red, tint, deep}}, {.surface = lab.palette.surface});
  lab.expect(ladder, true);
  EXPECT_EQ(ladder.reports[1].method, FitMethod::tints);
  EXPECT_NEAR(ladder.reports[1].residual, 0, 1e-12);
  EXPECT_TRUE(ladder.palette.pigments[1].k_error.empty());  // no repeats

  const auto drawdowns = [&](const std::string& paint) {
    return std::pair(lab.sample(paint, "0.03", 20e-6), lab.sample(paint, "0.8", 20e-6));
  };
  const auto [white_dark, white_light] = drawdowns("white");
  const auto [red_dark, red_light] = drawdowns("red");
  const Fit absolute =
      fit({lab.palette.nm, {white_light, white_dark, red_dark, red_light}}, {.surface = lab.palette.surface});
  lab.expect(absolute, false);
  EXPECT_EQ(absolute.reports[0].method, FitMethod::drawdowns);
  const Fit mixed =
      fit({lab.palette.nm, {white_light, white_dark, red, tint}}, {.surface = lab.palette.surface});
  lab.expect(mixed, false);
  EXPECT_EQ(mixed.reports[1].method, FitMethod::tints);
  lab.expect(fit({lab.palette.nm, {white, white_dark, red, red_dark}}, {.surface = lab.palette.surface}),
             false);
  lab.expect(fit({lab.palette.nm,
                  {lab.sample("white", "none", 10e-6), lab.sample("white", "none", 10e-6, true),
                   lab.sample("red", "none", 10e-6), lab.sample("red", "none", 10e-6, true)}},
                 {.surface = lab.palette.surface}),
             false);
  // A substrate that was measured bare, under the same interface.
  Sample card;
  card.name = "card";
  card.values.assign(3, outer_reflectance(lab.palette.surface, 0.8));
  Sample over_card = white_light;
  over_card.backing = "card";
  lab.expect(fit({lab.palette.nm, {card, over_card, white_dark}}, {.surface = lab.palette.surface}), false);
}

TEST(PigmentFit, ErrorsOfRepeats) {
  // White's K/S alone: the jackknife of a mean is its standard error, carried by the slope of K/S.
  const SampleTable table = table_of("paints,500\nwhite,0.80\nwhite,0.82\nwhite,0.81\n");
  const Fit f = fit(table);
  const double slope = std::abs(0.5 - 0.5 / (0.81 * 0.81)), error = 0.01 / std::sqrt(3.0);
  EXPECT_NEAR(f.palette.pigments[0].k_error[0], slope * error, 2e-2 * slope * error);
  EXPECT_EQ(f.palette.pigments[0].s_error[0], 0);
  EXPECT_EQ(f.reports[0].measurements, 3);
  const auto left_out = leave_one_repeat_out(table);
  ASSERT_EQ(left_out.size(), 3u);
  EXPECT_NEAR(left_out[0].predicted[0], 0.815, 1e-12);
  EXPECT_NEAR(left_out[0].rms, 0.015, 1e-12);
}

TEST(PigmentFit, ContradictionsAreCounted) {
  // The tint is darker than its masstone, which no positive S explains.
  const Fit f = fit(table_of("paints,500,600\nwhite,0.9,0.9\nred,0.3,0.3\nred: 1 + white: 1,0.2,0.5\n"));
  EXPECT_EQ(f.reports[1].negative_s, 1);
  EXPECT_EQ(f.reports[1].negative_k, 1);
  EXPECT_EQ(f.reports[1].negative_from_nm, 500);
  EXPECT_LT(f.palette.pigments[1].s[0], 0);
  EXPECT_GT(f.palette.pigments[1].s[1], 0);
}

TEST(PigmentFit, MissingMeasurementsAreNamed) {
  const auto says = [](const std::string& text, const std::string& part, const FitSettings& settings = {}) {
    try {
      fit(table_of(text), settings);
      ADD_FAILURE() << "no error: " << text;
    } catch (const std::domain_error& e) {
      EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
    }
  };
  says("paints,500\nwhite,0.9\nred,0.3\n", "an opaque tint with \"white\" is missing");
  says("paints,500\nwhite,0.9\nred: 1 + white: 3,0.3\n", "\"red\": its opaque masstone is missing");
  says("paints,500\nred,0.3\nred: 1 + chalk: 3,0.5\n", "an opaque tint with \"white\" is missing");
  says("paints,500\nred,0.3\nchalk,0.9\nred: 1 + chalk: 3,0.5\n", "missing", {.white = "white"});
  says("paints,500,backing,thickness_um\nred,0.3,0.8,20\n", "over a second substrate");
  says("paints,500,backing,thickness_um\nred,0.3,0.8,\n", "needs its thickness");
  says("paints,500,backing,thickness_um\nred,0.3,0,20\nred,0.4,0.8,20\nwhite,0.9,,\n",
       "a drawdown of \"white\" with its thickness is missing");
  says("paints,500,backing,thickness_um\nred,0.3,cork,20\n", "no bare substrate \"cork\"");
  says("paints,500,600\nwhite,0.9,0.03\n",
       "at 600 nm: reflectance 0.03 is below what the interface itself reflects",
       {.surface = saunderson_surface(0.04, 0.6, Specular::included)});
  says("paints,500\nwhite,1.1\n", "above that of a perfect white");
}

TEST(PigmentSamples, PlacesOfErrors) {
  const auto where = [](const std::string& text, int line, int column) {
    try {
      table_of(text);
      ADD_FAILURE() << "no error: " << text;
    } catch (const TextError& e) {
      EXPECT_EQ(e.line(), line) << e.what();
      EXPECT_EQ(e.column(), column) << e.what();
    }
  };
  where("# comment\n\npaints,500\nwhite,bright\n", 4, 7);
  where("paints,500\nwhite,nan\n", 2, 7);
  where("paints,500\nwhite\n", 2, 0);
  where("paints,500,400,500\n", 1, 12);
  where("paints,thicknes,500\n", 1, 8);
  where("nm\twhite\tred\n500\t0.9\t0.5\n600\t0.9\tdark\n", 3, 9);
  where("paints;500\nwhite;0,9\nred;0,x\n", 3, 5);
  where("paints,sample\nwhite,x\n", 1, 0);
  where("paints,unit,500\nwhite,per mille,80\n", 2, 7);
  where("paints,thickness_um,500\nwhite,0,0.8\n", 2, 7);
  where("paints,500\n red: 1 + white,0.8\n", 2, 2);
  where("paints,500\n\"red,0.8\n", 2, 1);
  where("", 0, 0);
  EXPECT_NEAR(table_of("paints,unit,500\nwhite,percent,80\n").samples[0].values[0], 0.8, 1e-15);
}

/// One table in the forms that laboratories write.
TEST(PigmentSamples, AsLaboratoriesWriteThem) {
  const auto noted = [](const SampleTable& t, const std::string& part) {
    return std::any_of(t.notes.begin(), t.notes.end(),
                       [&](const std::string& n) { return n.find(part) != n.npos; });
  };
  const auto expect = [](const SampleTable& t, const std::string& from) {
    ASSERT_EQ(t.nm, (std::vector<double>{400, 500, 700})) << from;
    ASSERT_EQ(t.samples.size(), 2u) << from;
    EXPECT_EQ(t.samples[0].paints[0].name, "white") << from;
    ASSERT_EQ(t.samples[1].paints.size(), 2u) << from;
    EXPECT_NEAR(t.samples[1].paints[0].fraction, 0.1, 1e-12) << from;
    const double values[2][3] = {{0.821, 0.902, 0.91}, {0.401, 0.455, 0.802}};
    for (std::size_t s = 0; s < 2; ++s)
      for (std::size_t l = 0; l < 3; ++l) EXPECT_NEAR(t.samples[s].values[l], values[s][l], 1e-12) << from;
  };
  const std::string plain =
      "paints,unit,400,500,700\nwhite,percent,82.1,90.2,91\nred: 1 + white: 9,percent,40.1,45.5,80.2\n";
  expect(table_of(plain), "plain");
  EXPECT_TRUE(table_of(plain).notes.empty());
  const std::string german =
      "Messung 17\r\nGer\xC3\xA4t;SP\r\n\r\nPaints;R 400 nm;R500nm;R_700;L*\r\nwhite;82,1;90,2;91;90\r\n"
      "\"red: 1 + white: 9\";40,1;45,5;80,2;70\r\n";
  const SampleTable from_german = table_of(german);
  expect(from_german, "semicolons and decimal commas");
  EXPECT_EQ(from_german.samples[1].line, 6);
  for (const char* part : {"begins in line 4; 2 lines", "\"L*\" is not used", "decimal commas", "per cent"})
    EXPECT_TRUE(noted(from_german, part)) << part;
  std::string wide = "\xFF\xFE";
  for (const char c : plain) wide += {c, '\0'};
  expect(table_of(wide), "UTF-16");
  std::string big;
  for (const char c : plain) big += {'\0', c};
  expect(table_of(big), "UTF-16 without a mark, big endian");
  expect(table_of("\xEF\xBB\xBFPAINTS\t%R700\t%R500\t%R400\nwhite\t91\t90.2\t82.1\n"
                  "red: 1 + white: 9\t80.2\t45.5\t40.1\n"),
         "tabs, per cent in headings, descending");
  const SampleTable down =
      table_of("Wavelength (nm),white,red: 1 + white: 9\n700,0.91,0.802\n500,0.902,0.455\n400,0.821,0.401\n");
  expect(down, "wavelengths down");
  EXPECT_EQ(down.samples[1].lines, (std::vector<int>{4, 3, 2}));
  expect(
      table_of(
          "paints;white;red: 1 + white: 9\nbacking;;\nnm400;0,821;0,401\nnm500;0,902;0,455\nnm700;0,91;0,802\n"),
      "wavelengths down with keys");

  const SampleTable repeats = table_of("paints,400,500,400,500\nwhite,0.8,0.9,0.82,0.92\n");
  ASSERT_EQ(repeats.samples.size(), 2u);
  EXPECT_EQ(repeats.samples[1].values, (std::vector<double>{0.82, 0.92}));
  EXPECT_TRUE(noted(repeats, "repeats"));
  const SampleTable thin = table_of("paints,backing,thickness_um,400,500\nwhite,0.1,0.024,0.5,0.5\n");
  EXPECT_TRUE(noted(thin, "0.024 um is thinner than a wavelength"));
  EXPECT_NEAR(
      table_of("paints,backing,thickness (mm),400,500\nwhite,0.1,0.024,0.5,0.5\n").samples[0].thickness,
      24e-6, 1e-18);
  EXPECT_TRUE(noted(table_of("paints,400,500\nred: 10.4 + white: 89.9,0.5,0.5\n"), "sum to 100.3"));
  EXPECT_TRUE(table_of("paints,400,500\nred: 1 + white: 89,0.5,0.5\n").notes.size() == 1);
  EXPECT_TRUE(table_of("paints,400,500\nred: 1 + white: 9,0.5,0.5\n").notes.empty());
  EXPECT_EQ(table_of("sample,specimen,series,paints,400,500\na,1,b,white,0.5,0.5\n").samples[0].series, "b");
}

TEST(PigmentSamples, CgatsWithWavelengthsInTheData) {
  std::istringstream text(
      "CGATS.17\nBEGIN_DATA_FORMAT\nSAMPLE_NAME SERIES SPECTRAL_NM SPECTRAL_DEC SPECTRAL_NM SPECTRAL_DEC\n"
      "END_DATA_FORMAT\nBEGIN_DATA\nwhite a 500 0.9 400 0.8\nred a 500 0.1 400 0.2\nEND_DATA\n");
  const SampleTable t = read_cgats(text);
  EXPECT_EQ(t.nm, (std::vector<double>{400, 500}));
  EXPECT_EQ(t.samples[1].values, (std::vector<double>{0.2, 0.1}));
  EXPECT_EQ(t.samples[1].series, "a");
  std::istringstream other(
      "CGATS.17\nBEGIN_DATA_FORMAT\nSAMPLE_NAME SPECTRAL_NM SPECTRAL_PCT\nEND_DATA_FORMAT\nBEGIN_DATA\n"
      "white 500 90\nred 510 10\nEND_DATA\n");
  try {
    read_cgats(other);
    ADD_FAILURE();
  } catch (const TextError& e) {
    EXPECT_EQ(e.line(), 7);
    EXPECT_NE(std::string(e.what()).find("wavelength of the first row, 500"), std::string::npos) << e.what();
  }
}

TEST(PigmentRecipe, PartsAndPerCent) {
  const auto recipe = parse_recipe(" cold yellow: 0.19 + white: 0.35 ");
  ASSERT_EQ(recipe.size(), 2u);
  EXPECT_EQ(recipe[0].name, "cold yellow");
  EXPECT_NEAR(recipe[0].fraction, 0.19 / 0.54, 1e-15);
  EXPECT_EQ(recipe_text(parse_recipe("red: 25% + white: 75%"), 1), "red: 25.0% + white: 75.0%");
  EXPECT_EQ(recipe_text(parse_recipe("25% red + 75 % white"), 1), "red: 25.0% + white: 75.0%");
  EXPECT_EQ(recipe_text(parse_recipe("25% red + white: 75%"), 1), "red: 25.0% + white: 75.0%");
  EXPECT_EQ(parse_recipe("50% cyan")[0].name, "50% cyan");
  EXPECT_EQ(parse_recipe("white")[0].fraction, 1);
  for (const char* wrong :
       {"", "10% red + 80% white", "10% + 90% white", "red + white", "red: 1 + white", "red: -1 + white: 2",
        "red: 0 + white: 1", "red: 1 + red: 2", "red: 30% + white: 60%", "red: 30% + white: 0.7",
        "red: x + white: 1", "red: 1 + : 1"})
    EXPECT_THROW(parse_recipe(wrong), std::domain_error) << wrong;
}

TEST(PaletteText, ComesBack) {
  Palette p = kimera_fit().palette;
  p.pigments[2].density = 1234.5, p.pigments[1].g = 0.7;
  p.streams = PaletteStreams{
      .index = 1.48, .g = 0.6, .geometry = Geometry::angle_45_0, .specular = Specular::included};
  std::istringstream text(palette_text(p));
  const Palette back = read_palette(text);
  EXPECT_EQ(back.nm, p.nm);
  EXPECT_EQ(back.surface.through, p.surface.through);
  EXPECT_EQ(back.pigments[2].density, 1234.5);
  EXPECT_EQ(back.streams, p.streams);
  EXPECT_EQ(back.pigments[1].g, 0.7);
  EXPECT_FALSE(back.pigments[0].g);
  p.streams.reset();
  std::istringstream by_two_fluxes(palette_text(p));
  EXPECT_FALSE(read_palette(by_two_fluxes).streams);
  for (std::size_t i = 0; i < p.pigments.size(); ++i) {
    EXPECT_EQ(back.pigments[i].name, p.pigments[i].name);
    EXPECT_EQ(back.pigments[i].k, p.pigments[i].k);
    EXPECT_EQ(back.pigments[i].s_error, p.pigments[i].s_error);
  }
  for (const char* wrong :
       {"", "unit,furlong\nnm,a K,a S\n500,1,1\n", "nm,a K\n500,1\n", "nm,a K,a S,a Q\n500,1,1,1\n",
        "theory,streams\nstreams g,1\nnm,a K,a S\n500,1,1\n", "g b,0.5\nnm,a K,a S\n500,1,1\n",
        "streams geometry,45/0\nnm,a K,a S\n500,1,1\n", "nm,a K,a S\n500,1\n",
        "colour,red\nnm,a K,a S\n500,1,1\n", "density b,1\nnm,a K,a S\n500,1,1\n"}) {
    std::istringstream stream(wrong);
    EXPECT_THROW(read_palette(stream), TextError) << wrong;
  }
}

TEST(MeasuredPaints, RepeatsArePredicted) {
  const SampleTable& table = kimera_samples();
  EXPECT_EQ(table.samples.size(), 75u);
  EXPECT_EQ(table.nm.size(), 170u);
  const Fit& f = kimera_fit();
  ASSERT_EQ(f.palette.pigments.size(), 13u);
  EXPECT_TRUE(f.palette.relative);
  for (std::size_t p = 0; p < 13; ++p) {
    EXPECT_EQ(f.reports[p].negative_k + f.reports[p].negative_s + f.reports[p].undefined, 0)
        << f.palette.pigments[p].name;
    EXPECT_EQ(f.palette.pigments[p].k_error.size(), 170u);
  }
  // Each measurement from the others: the repeats differ by this much, and the theory adds nothing to it
  // where the fit has as many numbers as data. The white's first repeat is the odd one.
  double worst = 0, sum = 0;
  const auto left_out = leave_one_repeat_out(table, {.surface = kimera_surface()});
  ASSERT_EQ(left_out.size(), 75u);
  for (const LeftOut& l : left_out) worst = std::max(worst, l.rms), sum += l.rms / 75;
  RecordProperty("worst_rms", std::to_string(worst));
  RecordProperty("mean_rms", std::to_string(sum));
  EXPECT_LT(worst, 0.03);
  EXPECT_LT(sum, 0.005);
}

TEST(MeasuredPaints, SpecularLightWasNotCounted) {
  // With the interface's own 4 % the darkest paints would reflect less than nothing.
  EXPECT_THROW(
      fit(kimera_samples(), {.surface = smooth_surface(1.5, Geometry::diffuse_8, Specular::included)}),
      SampleError);
}

}  // namespace
}  // namespace aureole::pigment
