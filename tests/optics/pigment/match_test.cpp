// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/match.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>
#include <stdexcept>

#include "aureole/pigment/measured_paints.h"
#include "aureole/pigment/streams_mixture.h"

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

/// Paints with a white, a black and bands of absorption at different wavelengths, made from a seed; every 10 nm.
Palette synthetic_palette(int count) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(0, 1);
  Palette palette;
  for (double l = 400; l <= 700; l += 10) palette.nm.push_back(l);
  palette.surface = kimera_surface();
  for (int p = 0; p < count; ++p) {
    Pigment& one = palette.pigments.emplace_back();
    one.name = "p" + std::to_string(p);
    const double centre = 380 + 340 * uniform(random), width = 25 + 60 * uniform(random),
                 strength = std::exp(4 * uniform(random) - 1), scattering = std::exp(2 * uniform(random) - 2);
    for (const double l : palette.nm) {
      const double band = std::exp(-std::pow((l - centre) / width, 2));
      one.k.push_back(p == 0 ? 0.002 : p == 1 ? 20 : strength * (band + 0.01));
      one.s.push_back(p == 0 ? 1 : p == 1 ? 0.05 : scattering * std::sqrt(550 / l));
    }
  }
  return palette;
}

Observation observation_at(const std::vector<double>& nm, double kelvin) {
  const auto bell = [](double centre, double width) {
    return [=](double l) { return std::exp(-std::pow((l - centre) / width, 2)); };
  };
  return Observation(
      "lamp", nm, [=](double l) { return std::pow(l, -5) / std::expm1(1.4388e7 / (l * kelvin)); },
      {[=](double l) { return bell(600, 50)(l) + 0.35 * bell(445, 28)(l); }, bell(555, 60), bell(450, 35)});
}

/// 102,090 sets of at most four of 40 paints: the recipe of a mixture of four comes back, as the one that matches under
/// all lamps. The time is for two threads.
TEST(PigmentMatch, FourOfFortyPaints) {
  const Palette palette = synthetic_palette(40);
  const Observation day = observation_at(palette.nm, 6500);
  const std::vector<Observation> others{observation_at(palette.nm, 2856)};
  std::vector<double> truth(40);
  truth[0] = 0.8, truth[5] = 0.12, truth[17] = 0.05, truth[30] = 0.03;
  const auto r = paint_reflectance(mix(palette, truth), kInfinity, {}, palette.surface);
  const auto start = std::chrono::steady_clock::now();
  const auto found = match(palette, {day.lab(r), r}, day, others, {.max_paints = 4}, std_thread_for(2));
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::printf("4 of 40 paints: %.2f s, Delta E %.2g\n", seconds, found[0].difference);
  EXPECT_LT(found[0].difference, 1e-3);
  for (std::size_t i = 0; i < truth.size(); ++i)
    EXPECT_NEAR(found[0].fractions[i], truth[i], 0.01 * truth[i] + 1e-9);
}

/// As `FourOfFortyPaints`, with a palette by streams, and three of thirteen of its paints as a film over a card.
TEST(PigmentMatch, FourOfFortyPaintsByStreams) {
  Palette palette = synthetic_palette(40);
  palette.streams = PaletteStreams{.index = 1.5, .g = 0.8};
  const StreamsMixture streams(palette, std_thread_for(2));
  const Observation day = observation_at(palette.nm, 6500);
  const std::vector<Observation> others{observation_at(palette.nm, 2856)};
  std::vector<double> truth(40);
  truth[0] = 0.8, truth[5] = 0.12, truth[17] = 0.05, truth[30] = 0.03;
  const auto timed = [&](const char* what, const MatchTarget& target, const MatchSettings& settings) {
    const auto start = std::chrono::steady_clock::now();
    const auto found = match(palette, target, day, others, settings, std_thread_for(2));
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::printf("%s: %.2f s with the tables of the theory, Delta E %.2g\n", what, seconds,
                found[0].difference);
    return found;
  };
  const auto r = streams.reflectance(truth, kInfinity, {});
  const auto found = timed("4 of 40 paints", {day.lab(r), r}, {.max_paints = 4});
  EXPECT_LT(found[0].difference, 5e-3);
  for (std::size_t i = 0; i < truth.size(); ++i)
    EXPECT_NEAR(found[0].fractions[i], truth[i], 0.02 * truth[i] + 1e-9);
  MatchSettings film{.max_paints = 3, .thickness = 0.4, .substrate = {0.3}};
  film.most.assign(40, 0);
  std::fill_n(film.most.begin(), 13, 1);
  std::fill(truth.begin(), truth.end(), 0);
  truth[0] = 0.85, truth[3] = 0.1, truth[8] = 0.05;
  const auto over = streams.reflectance(truth, film.thickness, film.substrate);
  const auto films = timed("3 of 13 paints, a film", {day.lab(over), over}, film);
  for (std::size_t i = 0; i < truth.size(); ++i)
    EXPECT_NEAR(films[0].fractions[i], truth[i], 0.02 * truth[i] + 1e-9);
}

/// Sets of four are tried only where a paint more helps. Nothing is lost against trying all sets of twelve paints.
TEST(PigmentMatch, SearchesOfManySetsLoseNothing) {
  const Palette palette = synthetic_palette(18);
  const Observation day = observation_at(palette.nm, 6500);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int trial = 0; trial < 4; ++trial) {
    const Lab target{20 + 70 * uniform(random), 120 * uniform(random) - 60, 120 * uniform(random) - 60};
    const double best = match(palette, {target}, day, {}, {.max_paints = 4, .solutions = 1})[0].difference;
    std::vector<std::size_t> order(18);
    for (std::size_t i = 0; i < 18; ++i) order[i] = i;
    for (int part = 0; part < 3; ++part) {
      std::shuffle(order.begin(), order.end(), random);
      MatchSettings settings{.max_paints = 4, .solutions = 1};
      settings.most.assign(18, 1);
      for (std::size_t i = 12; i < 18; ++i) settings.most[order[i]] = 0;
      EXPECT_LE(best, match(palette, {target}, day, {}, settings)[0].difference + 1e-3) << trial;
    }
  }
}

TEST(PigmentMatch, ForbiddenPairsSmallestAmountsAndPrices) {
  const Bench bench;
  const MatchTarget target = bench.target("violet: 0.5% + green: 1% + white: 98.5%");
  const auto violet = *bench.palette.find("violet"), green = *bench.palette.find("green");
  MatchSettings settings{.solutions = 50, .forbidden = {{green, violet}}};
  settings.price.assign(13, 2), settings.price[violet] = 30;
  for (const Match& m : match(bench.palette, target, bench.day, bench.others, settings)) {
    EXPECT_TRUE(m.fractions[violet] == 0 || m.fractions[green] == 0);
    EXPECT_NEAR(m.cost, 2 + 28 * m.fractions[violet], 1e-12);
  }
  settings.forbidden.clear(), settings.smallest = 0.008;
  for (const Match& m : match(bench.palette, target, bench.day, bench.others, settings))
    for (const double f : m.fractions) EXPECT_TRUE(f == 0 || f >= 0.008);
}

/// No recipe of the trade-offs is better than another one in everything, and of all recipes none is better than one of
/// them in everything by more than the steps of the comparison.
TEST(PigmentMatch, TradeOffsAreNotDominated) {
  const Bench bench;
  const MatchTarget target = bench.target("red: 15% + cold yellow: 5% + white: 80%");
  MatchSettings settings{.solutions = 1000};
  for (std::size_t i = 0; i < 13; ++i) settings.price.push_back(1 + double(i * 7 % 13));
  const auto all = match(bench.palette, target, bench.day, bench.others, settings);
  settings.trade_offs = true, settings.within = 3;
  const auto front = match(bench.palette, target, bench.day, bench.others, settings);
  ASSERT_GT(front.size(), 2u);
  const auto better = [](const Match& a, const Match& b) {
    return a.difference < b.difference - 0.02 && a.cost < b.cost - 1e-5 &&
           a.metamerism() < b.metamerism() - 0.02;
  };
  for (const Match& m : front) {
    EXPECT_LE(m.difference, 3);
    for (const Match& other : all) EXPECT_FALSE(better(other, m));
  }
  settings.solutions = 3;
  const auto few = match(bench.palette, target, bench.day, bench.others, settings);
  ASSERT_EQ(few.size(), 3u);
  const auto cheapest = [](const std::vector<Match>& of) {
    double least = kInfinity;
    for (const Match& m : of) least = std::min(least, m.cost);
    return least;
  };
  EXPECT_NEAR(cheapest(few), cheapest(front), 1e-12);
  settings.within = 1e-9;
  EXPECT_THROW(match(bench.palette, {{50, 100, 100}}, bench.day, {}, settings), std::domain_error);
}

/// A paint and white: 1 % more of the paint changes its fraction f by 1 % f (1 - f)/(1 + f/100).
TEST(PigmentMatch, DosingErrors) {
  const Bench bench;
  const auto found =
      match(bench.palette, bench.target("red: 20% + white: 80%"), bench.day, {}, {.max_paints = 2});
  const auto red = *bench.palette.find("red"), white = *bench.palette.find("white");
  const double f = found[0].fractions[red], more = 1.01 * f / (1 + 0.01 * f);
  std::vector<double> shares(13);
  shares[red] = more, shares[white] = 1 - more;
  const auto r = paint_reflectance(mix(bench.palette, shares), kInfinity, {}, bench.palette.surface);
  EXPECT_NEAR(found[0].dosing[red], ciede2000(found[0].lab, bench.day.lab(r)), 1e-9);
  EXPECT_NEAR(found[0].dosing_error, std::hypot(found[0].dosing[red], found[0].dosing[white]), 1e-12);
  EXPECT_GT(found[0].dosing_error, 0.01);
}

/// By the spectrum the rms is smaller than by the colour, which is nearer in colour; by all lamps the largest difference
/// is smaller.
TEST(PigmentMatch, ByColourLampsOrSpectrum) {
  const Bench bench;
  MatchTarget target = bench.target("magenta: 33% + orange: 33% + yellow oxide: 34%");
  for (std::size_t i = 0; i < target.reflectance.size(); ++i)
    target.reflectance[i] += 0.02 * std::sin(0.05 * double(i));
  target.lab = bench.day.lab(target.reflectance);
  const auto best = [&](MatchBy by) {
    return match(bench.palette, target, bench.day, bench.others, {.solutions = 1, .by = by})[0];
  };
  const Match colour = best(MatchBy::colour), lamps = best(MatchBy::lamps),
              spectrum = best(MatchBy::spectrum);
  EXPECT_LT(spectrum.rms, colour.rms);
  EXPECT_LE(colour.difference, spectrum.difference + 1e-9);
  EXPECT_LT(std::hypot(lamps.difference, lamps.metamerism()),
            std::hypot(colour.difference, colour.metamerism()));
  EXPECT_THROW(match(bench.palette, {{50, 0, 0}}, bench.day, {}, {.by = MatchBy::spectrum}),
               std::domain_error);
}

TEST(PigmentMatch, ContrastAtAThickness) {
  const Bench bench;
  const MatchTarget target = bench.target("cold yellow: 60% + white: 40%");
  MatchSettings settings{.thickness = 3, .substrate = {0.8}, .least_contrast = 0.9};
  const auto found = match(bench.palette, target, bench.day, {}, settings);
  for (const Match& m : found) {
    EXPECT_GE(m.contrast, 0.9);
    const Paint paint = mix(bench.palette, m.fractions);
    const auto luminous = [&](double below) {
      const double substrate[] = {below};
      return bench.day.xyz(paint_reflectance(paint, 3, substrate, bench.palette.surface))[1];
    };
    EXPECT_NEAR(m.contrast, luminous(0) / luminous(0.8), 1e-9);
  }
  settings.thickness = 0.01;
  EXPECT_THROW(match(bench.palette, target, bench.day, {}, settings), std::domain_error);
  settings.thickness = kInfinity;
  EXPECT_THROW(match(bench.palette, target, bench.day, {}, settings), std::domain_error);
}

/// The smallest colour difference over a grid of all mixtures of two or three paints within bounds and with a contrast
/// ratio at a thickness, and over two finer grids around the best point. No search is shared with `match`.
struct GridSearch {
  const Bench& bench;
  std::vector<std::size_t> paints;
  Lab target;
  std::vector<double> least, most;  ///< of each of the paints
  double thickness = kInfinity, contrast = 0;

  double value(const std::vector<double>& shares) const {
    std::vector<double> all(bench.palette.pigments.size());
    for (std::size_t p = 0; p < paints.size(); ++p) {
      if (shares[p] < least[p] - 1e-12 || shares[p] > most[p] + 1e-12) return kInfinity;
      all[paints[p]] = shares[p];
    }
    const Paint paint = mix(bench.palette, all);
    const auto over = [&](double below) {
      const double substrate[] = {below};
      return paint_reflectance(paint, thickness, substrate, bench.palette.surface);
    };
    if (std::isinf(thickness))
      return ciede2000(target, bench.day.lab(paint_reflectance(paint, kInfinity, {}, bench.palette.surface)));
    const std::vector<double> white = over(0.8);
    if (bench.day.xyz(over(0))[1] < (contrast - 1e-9) * bench.day.xyz(white)[1]) return kInfinity;
    return ciede2000(target, bench.day.lab(white));
  }

  double best(double step = 1.0 / 128) const {
    double reached = kInfinity, a_best = 0.5, b_best = 0.5, width = 0.5;
    for (int level = 0; level < 3; ++level) {
      const double a0 = a_best, b0 = b_best;
      for (double a = std::max(0.0, a0 - width); a <= std::min(1.0, a0 + width); a += step) {
        if (paints.size() == 2) {
          if (const double v = value({a, 1 - a}); v < reached) reached = v, a_best = a;
          continue;
        }
        for (double b = std::max(0.0, b0 - width); b <= std::min(1 - a, b0 + width); b += step)
          if (const double v = value({a, b, 1 - a - b}); v < reached) reached = v, a_best = a, b_best = b;
      }
      width = 2 * step, step /= 16;
    }
    return reached;
  }
};

struct SearchCase {
  std::vector<std::string> paints;
  Lab target;
  std::vector<double> least, most;
  double thickness = kInfinity, contrast = 0;
};

/// No worse than the grid, by all sets of the paints, whose smaller ones the grid holds as its edges.
void expect_as_good_as_grid(const SearchCase& c) {
  const Bench bench;
  GridSearch grid{bench, {}, c.target, c.least, c.most, c.thickness, c.contrast};
  MatchSettings settings{
      .solutions = 1, .thickness = c.thickness, .substrate = {0.8}, .least_contrast = c.contrast};
  settings.least.assign(13, 0), settings.most.assign(13, 0);
  for (std::size_t p = 0; p < c.paints.size(); ++p) {
    const std::size_t at = *bench.palette.find(c.paints[p]);
    grid.paints.push_back(at), settings.least[at] = c.least[p], settings.most[at] = c.most[p];
  }
  const double reference = grid.best(std::isinf(c.thickness) ? 1.0 / 128 : 1.0 / 64);
  ASSERT_LT(reference, kInfinity);
  const Match found = match(bench.palette, {c.target}, bench.day, {}, settings)[0];
  std::printf("%s, %s%s%s: grid %.3f, found %.3f, contrast %.4f\n", c.paints[0].c_str(), c.paints[1].c_str(),
              c.paints.size() > 2 ? ", " : "", c.paints.size() > 2 ? c.paints[2].c_str() : "", reference,
              found.difference, found.contrast);
  EXPECT_LE(found.difference, reference + 0.002);
  EXPECT_GE(found.contrast, c.contrast);
  std::vector<double> shares;
  for (const std::size_t p : grid.paints) shares.push_back(found.fractions[p]);
  EXPECT_LT(grid.value(shares), found.difference + 1e-9);  // within the bounds
}

TEST(PigmentMatch, BoundedRecipesAreAsGoodAsAGrid) {
  expect_as_good_as_grid(
      {{"white", "violet", "warm yellow"}, {44.622, 7.354, 5.689}, {0, 0, 0}, {0.51, 1, 1}});
  expect_as_good_as_grid(
      {{"white", "warm yellow", "cold yellow"}, {82.301, 12.143, 77.446}, {0.63, 0, 0}, {1, 1, 1}});
  expect_as_good_as_grid(
      {{"white", "blue red shade", "black"}, {53.24, -14.35, -37.55}, {0, 0, 0.02}, {0.6, 1, 1}});
  expect_as_good_as_grid(
      {{"white", "blue green shade", "red"}, {50, 10, -30}, {0.8, 0, 0.05}, {1, 0.1, 0.3}});
  expect_as_good_as_grid({{"white", "black"}, {70, 0, 0}, {0, 0.2}, {1, 1}});
}

TEST(PigmentMatch, HidingRecipesAreAsGoodAsAGrid) {
  const std::vector<double> none(3, 0), all(3, 1);
  for (const double contrast : {0.95, 0.98}) {
    expect_as_good_as_grid({{"white", "orange", "black"}, {81.34, 9.71, 11.96}, none, all, 3, contrast});
    expect_as_good_as_grid(
        {{"white", "warm yellow", "violet"}, {81.34, 9.71, 11.96}, none, all, 3, contrast});
    expect_as_good_as_grid({{"white", "black"}, {60, 0, 0}, {0, 0}, {1, 1}, 2, contrast});
    expect_as_good_as_grid({{"cold yellow", "black"}, {80, 0, 60}, {0, 0}, {1, 1}, 3, contrast});
  }
  // With a bound that is active, too.
  expect_as_good_as_grid(
      {{"white", "orange", "black"}, {81.34, 9.71, 11.96}, {0, 0.1, 0}, {1, 1, 0.1}, 3, 0.95});
}

/// A set is left out only if none of its mixtures has the least contrast ratio, and the message names the largest one.
TEST(PigmentMatch, LargestContrast) {
  const Bench bench;
  MatchSettings settings{.solutions = 100, .thickness = 1, .substrate = {0.8}, .least_contrast = 0.5};
  settings.most.assign(13, 0);
  const std::size_t white = *bench.palette.find("white"), yellow = *bench.palette.find("cold yellow");
  settings.most[white] = settings.most[yellow] = 1;
  const double nowhere[] = {0.0}, card[] = {0.8};
  double largest = 0;
  for (int i = 0; i <= 2000; ++i) {
    std::vector<double> shares(13);
    shares[white] = i / 2000.0, shares[yellow] = 1 - i / 2000.0;
    const Paint paint = mix(bench.palette, shares);
    const auto luminous = [&](std::span<const double> below) {
      return bench.day.xyz(paint_reflectance(paint, 1, below, bench.palette.surface))[1];
    };
    largest = std::max(largest, luminous(nowhere) / luminous(card));
  }
  const MatchTarget target{{60, 40, -40}};
  settings.least_contrast = largest - 1e-5;
  EXPECT_GE(match(bench.palette, target, bench.day, {}, settings)[0].contrast, largest - 1e-5);
  settings.least_contrast = largest + 1e-3;
  try {
    match(bench.palette, target, bench.day, {}, settings);
    ADD_FAILURE() << "no recipe hides so well";
  } catch (const std::domain_error& e) {
    const std::string text = e.what();
    const auto got = text.rfind("got ");
    ASSERT_NE(got, text.npos) << text;
    EXPECT_NEAR(std::stod(text.substr(got + 4)), largest, 1e-5) << text;
  }
}

/// Where a recipe has less of a paint than can be dosed, the smallest amount that can be is tried.
TEST(PigmentMatch, SmallestAmountsThatHide) {
  MatchSettings settings{
      .solutions = 1, .thickness = 3, .substrate = {0.8}, .smallest = 0.05, .least_contrast = 0.9};
  const Bench bench;
  const std::size_t white = *bench.palette.find("white"), black = *bench.palette.find("black");
  settings.most.assign(13, 0), settings.most[white] = settings.most[black] = 1;
  const GridSearch grid{bench, {white, black}, {85, 0, 0}, {0, 0.05}, {1, 1}, 3, 0.9};
  const Match found = match(bench.palette, {grid.target}, bench.day, {}, settings)[0];
  EXPECT_LE(found.difference, grid.best() + 0.002);
  EXPECT_GE(found.fractions[black], 0.05);
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
