// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/match.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <random>
#include <stdexcept>

#include "aureole/pigment/measured_paints.h"

namespace aureole::pigment {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The CIE 1931 observer by a fit of lobes (Wyman, Sloan & Shirley, JCGT 2, 2013, (4)), under a black body's
/// light.
Observation observation(const std::string& name, double kelvin) {
  const auto lobe = [](double l, double scale, double centre, double below, double above) {
    return scale * std::exp(-0.5 * std::pow((l - centre) / (l < centre ? below : above), 2));
  };
  return Observation(
      name, kimera_samples().nm,
      [=](double l) { return std::pow(l, -5) / std::expm1(1.4388e7 / (l * kelvin)); },
      {[=](double l) {
         return lobe(l, 1.056, 599.8, 37.9, 31.0) + lobe(l, 0.362, 442.0, 16.0, 26.7) +
                lobe(l, -0.065, 501.1, 20.4, 26.2);
       },
       [=](double l) { return lobe(l, 0.821, 568.8, 46.9, 40.5) + lobe(l, 0.286, 530.9, 16.3, 31.1); },
       [=](double l) { return lobe(l, 1.217, 437.0, 11.8, 36.0) + lobe(l, 0.681, 459.0, 26.0, 13.8); }});
}

struct Bench {
  const Palette& palette = kimera_fit().palette;
  Observation day = observation("day", 6500);
  std::vector<Observation> others{observation("evening", 2856)};

  std::vector<double> shares(const std::string& recipe) const {
    std::vector<double> f(palette.pigments.size());
    for (const Component& c : parse_recipe(recipe)) f[*palette.find(c.name)] = c.fraction;
    return f;
  }
  MatchTarget target(const std::string& recipe) const {
    const auto r = paint_reflectance(mix(palette, shares(recipe)), kInfinity, {}, palette.surface);
    return {day.lab(r), r};
  }
};

TEST(PigmentMatch, FindsTheRecipeOfAMixture) {
  const Bench bench;
  for (const char* recipe :
       {"red: 20% + white: 80%", "cold yellow: 30% + blue green shade: 2% + white: 68%",
        "black: 5% + warm yellow: 60% + red oxide: 35%", "violet: 0.5% + green: 1% + white: 98.5%",
        "magenta: 33% + orange: 33% + yellow oxide: 34%", "black"}) {
    const MatchTarget target = bench.target(recipe);
    const auto start = std::chrono::steady_clock::now();
    const auto found = match(bench.palette, target, bench.day, bench.others);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::printf("%-55s %.3f s, %zu solutions, Delta E %.2g\n", recipe, seconds, found.size(),
                found[0].difference);
    ASSERT_FALSE(found.empty());
    EXPECT_LT(found[0].difference, 1e-3) << recipe;
    EXPECT_LT(found[0].differences[0], 1e-2) << recipe;
    const auto truth = bench.shares(recipe);
    for (std::size_t i = 0; i < truth.size(); ++i)
      EXPECT_NEAR(found[0].fractions[i], truth[i], 0.01 * truth[i] + 1e-12)
          << recipe << ": " << bench.palette.pigments[i].name;
    for (std::size_t i = 1; i < found.size(); ++i)  // other sets of paints
      EXPECT_NE(found[i].fractions, found[0].fractions);
  }
}

TEST(PigmentMatch, NeverWorseThanOnePaint) {
  const Bench bench;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int trial = 0; trial < 5; ++trial) {
    const MatchTarget target{
        {50 + 45 * uniform(random), 80 * uniform(random), 80 * uniform(random)}};  // many impossible
    double best = kInfinity;
    for (const Pigment& p : bench.palette.pigments)
      best = std::min(best, ciede2000(bench.target(p.name).lab, target.lab));
    for (const int paints : {1, 2, 3}) {
      const auto found = match(bench.palette, target, bench.day, {}, {.max_paints = paints, .solutions = 1});
      EXPECT_LE(found[0].difference, best + 1e-9) << paints;
      EXPECT_LT(
          std::count_if(found[0].fractions.begin(), found[0].fractions.end(), [](double f) { return f > 0; }),
          paints + 1);
      best = found[0].difference;  // nor than with fewer
      double sum = 0;
      for (const double f : found[0].fractions) sum += f;
      EXPECT_NEAR(sum, 1, 1e-9);
    }
  }
}

TEST(PigmentMatch, KeepsBounds) {
  const Bench bench;
  MatchSettings settings;
  settings.least.assign(13, 0), settings.most.assign(13, 1);
  const auto white = *bench.palette.find("white"), red = *bench.palette.find("red");
  settings.least[white] = 0.5, settings.most[red] = 0.1;
  const auto found = match(bench.palette, bench.target("red: 60% + white: 40%"), bench.day, {}, settings);
  for (const Match& m : found) {
    EXPECT_GE(m.fractions[white], 0.5 - 1e-12);
    EXPECT_LE(m.fractions[red], 0.1 + 1e-12);
  }
  // With a third of red and of white at most, all else forbidden, no recipe is whole.
  settings.least.assign(13, 0), settings.most.assign(13, 0);
  settings.most[white] = settings.most[red] = 0.3;
  EXPECT_THROW(match(bench.palette, bench.target("red"), bench.day, {}, settings), std::domain_error);
  settings.most[white] = 1.1;
  EXPECT_THROW(match(bench.palette, bench.target("red"), bench.day, {}, settings), std::domain_error);
  EXPECT_THROW(match(bench.palette, bench.target("red"), bench.day, {}, {.max_paints = 7}),
               std::domain_error);
  EXPECT_THROW(match(bench.palette, {{50, 0, 0}, {0.5}}, bench.day), std::domain_error);
}

TEST(PigmentMatch, ThinLayersOverASubstrate) {
  Bench bench;
  const std::vector<double> substrate{0.6};
  const auto truth = bench.shares("blue red shade: 10% + white: 90%");
  const auto r = paint_reflectance(mix(bench.palette, truth), 0.8, substrate, bench.palette.surface);
  const auto found = match(bench.palette, {bench.day.lab(r), r}, bench.day, bench.others,
                           {.max_paints = 2, .thickness = 0.8, .substrate = substrate});
  for (std::size_t i = 0; i < truth.size(); ++i)
    EXPECT_NEAR(found[0].fractions[i], truth[i], 0.01 * truth[i] + 1e-12);
}

TEST(PigmentMatch, ThreadsDoNotChangeABit) {
  const Bench bench;
  const MatchTarget target = bench.target("orange: 7% + blue green shade: 3% + white: 90%");
  const auto one = match(bench.palette, target, bench.day, bench.others);
  const auto two = match(bench.palette, target, bench.day, bench.others, {}, std_thread_for(2));
  ASSERT_EQ(one.size(), two.size());
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_EQ(one[i].fractions, two[i].fractions);
}

}  // namespace
}  // namespace aureole::pigment
