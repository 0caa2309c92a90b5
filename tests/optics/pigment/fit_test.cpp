// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <sstream>

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
  where("paints,500,400\n", 1, 12);
  where("paint,500\n", 1, 1);
  where("paints,sample\nwhite,x\n", 1, 0);
  where("paints,unit,500\nwhite,per mille,80\n", 2, 7);
  where("paints,thickness_um,500\nwhite,0,0.8\n", 2, 7);
  where("paints,500\n red: 1 + white,0.8\n", 2, 2);
  where("paints,500\n\"red,0.8\n", 2, 1);
  where("", 0, 0);
  EXPECT_NEAR(table_of("paints,unit,500\nwhite,percent,80\n").samples[0].values[0], 0.8, 1e-15);
}

TEST(PigmentRecipe, PartsAndPerCent) {
  const auto recipe = parse_recipe(" cold yellow: 0.19 + white: 0.35 ");
  ASSERT_EQ(recipe.size(), 2u);
  EXPECT_EQ(recipe[0].name, "cold yellow");
  EXPECT_NEAR(recipe[0].fraction, 0.19 / 0.54, 1e-15);
  EXPECT_EQ(recipe_text(parse_recipe("red: 25% + white: 75%"), 1), "red: 25.0% + white: 75.0%");
  EXPECT_EQ(parse_recipe("white")[0].fraction, 1);
  for (const char* wrong :
       {"", "red + white", "red: 1 + white", "red: -1 + white: 2", "red: 0 + white: 1", "red: 1 + red: 2",
        "red: 30% + white: 60%", "red: 30% + white: 0.7", "red: x + white: 1", "red: 1 + : 1"})
    EXPECT_THROW(parse_recipe(wrong), std::domain_error) << wrong;
}

TEST(PaletteText, ComesBack) {
  Palette p = kimera_fit().palette;
  p.pigments[2].density = 1234.5;
  std::istringstream text(palette_text(p));
  const Palette back = read_palette(text);
  EXPECT_EQ(back.nm, p.nm);
  EXPECT_EQ(back.surface.through, p.surface.through);
  EXPECT_EQ(back.pigments[2].density, 1234.5);
  for (std::size_t i = 0; i < p.pigments.size(); ++i) {
    EXPECT_EQ(back.pigments[i].name, p.pigments[i].name);
    EXPECT_EQ(back.pigments[i].k, p.pigments[i].k);
    EXPECT_EQ(back.pigments[i].s_error, p.pigments[i].s_error);
  }
  for (const char* wrong :
       {"", "unit,furlong\nnm,a K,a S\n500,1,1\n", "nm,a K\n500,1\n", "nm,a K,a S,a Q\n500,1,1,1\n",
        "nm,a K,a S\n500,1\n", "colour,red\nnm,a K,a S\n500,1,1\n", "density b,1\nnm,a K,a S\n500,1,1\n"}) {
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
