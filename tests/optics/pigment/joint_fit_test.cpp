// SPDX-License-Identifier: Apache-2.0
// The joint fit of K and S against paints whose truth is known, and its two theories of a film against the
// closed forms and the solver by discrete ordinates.
#include "aureole/pigment/joint_fit.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>
#include <sstream>
#include <tuple>

#include "aureole/optics/stack/plane_stack.h"
#include "aureole/pigment/hold_out.h"
#include "aureole/pigment/kubelka_munk_layer.h"
#include "aureole/pigment/match.h"
#include "aureole/pigment/measured_paints.h"
#include "aureole/pigment/normal_chain.h"
#include "aureole/pigment/observation.h"
#include "aureole/pigment/palette_text.h"
#include "aureole/pigment/prediction.h"
#include "aureole/pigment/streams_mixture.h"

namespace aureole::pigment {
namespace {

/// Reflectance, by streams, of a film over a Lambertian card in the binder, for diffuse light, gloss excluded.
double diffuse_film(double k, double s, double g, double index, double card) {
  optics::StackDescription d;
  d.layers = {{k / 2, 4. / 3 * s / (1 - g), 1, optics::LegendrePhase::henyey_greenstein(g), index}};
  d.substrate = card;
  const optics::StackFluxes f = optics::PlaneStack(d, {16}).fluxes(optics::StackLight::diffuse());
  return f.reflectance - f.unscattered_reflectance;
}

TEST(FilmTheory, TwoFluxesAreTheClosedFormAndItsSlopesTheQuotients) {
  const Surface surface = saunderson_surface(0.0418, 0.5963, Specular::excluded);
  const auto theory = two_flux_theory(surface);
  for (const double k : {1e-6, 0.01, 1.0, 30.0})
    for (const double s : {1e-3, 0.1, 3.0, 200.0})
      for (const double card : {0.0, 0.3, 0.9}) {
        const double expected = outer_reflectance(surface, reflectance_over(layer({k, s}, 1), card));
        const FilmValue v = theory->over({std::log(k), std::log(s)}, card);
        EXPECT_NEAR(v.value, expected, 1e-9) << k << " " << s << " " << card;
        constexpr double kStep = 1e-5;
        const auto at = [&](double a, double b, double c) {
          return outer_reflectance(surface,
                                   reflectance_over(layer({k * std::exp(a), s * std::exp(b)}, 1), c));
        };
        EXPECT_NEAR(v.by_ln_k, (at(kStep, 0, card) - at(-kStep, 0, card)) / (2 * kStep), 1e-6);
        EXPECT_NEAR(v.by_ln_s, (at(0, kStep, card) - at(0, -kStep, card)) / (2 * kStep), 1e-6);
        EXPECT_NEAR(v.by_substrate, (at(0, 0, card + kStep) - at(0, 0, card)) / kStep, 1e-4);
      }
  EXPECT_NEAR(theory->opaque({std::log(0.5), 0}).value, outer_reflectance(surface, 0.381966011250105), 1e-12);
  EXPECT_NEAR(theory->card(outer_reflectance(surface, 0.7)), 0.7, 1e-12);
}

TEST(FilmTheory, StreamsAreTheSolverOfStacks) {
  const StreamsSettings settings{.index = 1.5, .g = 0.6, .geometry = Geometry::diffuse_diffuse};
  const auto theory = streams_theory(settings);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> ln_k(-7, 3), ln_s(-4, 5), card(0, 1);
  for (int i = 0; i < 60; ++i) {
    const double k = ln_k(random), s = ln_s(random), r = card(random);
    // With a substrate the solver counts light that the card sends back within the layer.
    EXPECT_NEAR(theory->over({k, s}, r).value, diffuse_film(std::exp(k), std::exp(s), 0.6, 1.5, r), 2e-4)
        << k << " " << s << " " << r;
  }
  EXPECT_NEAR(theory->card(theory->over({-20, -20}, 0.8).value), 0.8, 2e-3);
  const double opaque = theory->opaque({std::log(0.05), 0}).value;
  EXPECT_NEAR(opaque, diffuse_film(0.05 * 1e3, 1e3, 0.6, 1.5, 0), 1e-3);
}

TEST(FilmTheory, StreamsTakeAnyMeanCosine) {
  const StreamsSettings settings{
      .index = 1.5, .g = 0.6, .geometry = Geometry::diffuse_diffuse, .varies_g = true};
  const auto theory = streams_theory(settings, std_thread_for());
  EXPECT_EQ(theory->mean_cosine(), 0.6);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> ln_k(-6, 2), ln_s(-3, 4), card(0, 1);
  for (const double g : {0.05, 0.2, 0.45, 0.6, 0.75, 0.85})
    for (int i = 0; i < 12; ++i) {
      const FilmLayer layer{ln_k(random), ln_s(random), std::log((1 - g) / 0.4)};
      const double r = card(random);
      const FilmValue v = theory->over(layer, r);
      EXPECT_NEAR(v.value, diffuse_film(std::exp(layer.ln_k), std::exp(layer.ln_s), g, 1.5, r), 1e-3)
          << g << " " << layer.ln_k << " " << layer.ln_s << " " << r;
      constexpr double kStep = 1e-4;
      FilmLayer more = layer, less = layer;
      more.g_shift += kStep, less.g_shift -= kStep;
      EXPECT_NEAR(v.by_g_shift, (theory->over(more, r).value - theory->over(less, r).value) / (2 * kStep),
                  1e-5);
    }
  // Beyond the tables the nearest one counts.
  EXPECT_EQ(theory->over({0, 0, -5}, 0.5).value, theory->over({0, 0, -4}, 0.5).value);
  EXPECT_EQ(theory->over({0, 0, -5}, 0.5).by_g_shift, 0);
}

TEST(NormalChain, SolvesAsTheDenseMatrix) {
  constexpr int kBlocks = 4, kSize = 3, kEdge = 2, kAll = kBlocks * kSize + kEdge;
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(kAll, kAll);
  NormalChain chain;
  chain.border = Eigen::MatrixXd::Identity(kEdge, kEdge);
  for (int l = 0; l < kBlocks; ++l) {
    const Eigen::MatrixXd j = Eigen::MatrixXd::NullaryExpr(5, kSize + kEdge, [&] { return normal(random); });
    const Eigen::MatrixXd a = j.leftCols(kSize), b = j.rightCols(kEdge);
    Eigen::MatrixXd block = a.transpose() * a;
    block.diagonal().array() += 4;
    chain.blocks.push_back(block), chain.to_border.push_back(a.transpose() * b);
    chain.border += b.transpose() * b;
    dense.block(l * kSize, l * kSize, kSize, kSize) = block;
    dense.block(l * kSize, kAll - kEdge, kSize, kEdge) = a.transpose() * b;
    dense.block(kAll - kEdge, l * kSize, kEdge, kSize) = b.transpose() * a;
  }
  dense.bottomRightCorner(kEdge, kEdge) = chain.border;
  for (int l = 0; l + 1 < kBlocks; ++l) {
    chain.coupling.push_back(Eigen::Vector3d(1, 0.5 + l, 2));
    for (int i = 0; i < kSize; ++i)
      dense(l * kSize + i, (l + 1) * kSize + i) = dense((l + 1) * kSize + i, l * kSize + i) =
          -chain.coupling.back()[i];
  }
  const Eigen::VectorXd right = Eigen::VectorXd::NullaryExpr(kAll, [&] { return normal(random); });
  std::vector<Eigen::MatrixXd> blocks;
  for (int l = 0; l < kBlocks; ++l) blocks.push_back(right.segment(l * kSize, kSize));
  Eigen::MatrixXd border = right.tail(kEdge);
  const NormalChainFactors factors(chain, 0);
  ASSERT_TRUE(factors.good());
  factors.solve(blocks, border);
  const Eigen::VectorXd expected = dense.fullPivLu().solve(right);
  for (int l = 0; l < kBlocks; ++l)
    for (int i = 0; i < kSize; ++i) EXPECT_NEAR(blocks[std::size_t(l)](i, 0), expected[l * kSize + i], 1e-10);
  for (int i = 0; i < kEdge; ++i) EXPECT_NEAR(border(i, 0), expected[kAll - kEdge + i], 1e-10);
}

/// A laboratory that knows its paints: per film, with or without errors.
struct Workshop {
  std::vector<double> nm;
  std::vector<std::string> names = {"white", "red", "black"};
  Surface surface = saunderson_surface(0.0418, 0.5963, Specular::excluded);
  std::vector<double> volumes = {1, 1, 1};  ///< per mass
  std::mt19937 random{7};

  Workshop() {
    for (double l = 400; l <= 700; l += 20) nm.push_back(l);
  }
  double k(int paint, double l) const {
    return paint == 0 ? 0.01 : paint == 1 ? 0.05 + 8 / (1 + std::exp((l - 580) / 15)) : 25;
  }
  double s(int paint, double l) const {
    return paint == 0 ? 8 * std::pow(550 / l, 1.3) : paint == 1 ? 1.5 : 2;
  }
  double reflectance(const std::vector<Component>& recipe, double l, double thickness, double card) const {
    double sum_k = 0, sum_s = 0, volume = 0;
    for (const Component& c : recipe) {
      const int p = c.name == "white" ? 0 : c.name == "red" ? 1 : 2;
      const double v = c.fraction * volumes[std::size_t(p)];
      sum_k += v * k(p, l), sum_s += v * s(p, l), volume += v;
    }
    return outer_reflectance(surface,
                             reflectance_over(layer({sum_k / volume, sum_s / volume}, thickness), card));
  }
  void add_card(SampleTable& table, const std::string& name, double inner) const {
    Sample s;
    s.name = name, s.values.assign(nm.size(), outer_reflectance(surface, inner));
    table.samples.push_back(s);
  }
  void add(SampleTable& table, const std::string& name, const std::string& recipe, double thickness,
           double noise) {
    std::normal_distribution<double> error(0, noise > 0 ? noise : 1);
    for (const auto& [card, inner] : {std::pair{"dark", 0.05}, {"light", 0.8}}) {
      Sample s;
      s.name = name + " over " + card, s.specimen = name, s.backing = card, s.paints = parse_recipe(recipe);
      for (const double l : nm)
        s.values.push_back(
            std::max(0.0, reflectance(s.paints, l, thickness, inner) + (noise > 0 ? error(random) : 0)));
      table.samples.push_back(s);
    }
  }
  SampleTable table(double noise) {
    SampleTable t{nm, {}};
    add_card(t, "dark", 0.05), add_card(t, "light", 0.8);
    for (const char* recipe : {"white", "red", "black: 1 + white: 9", "red: 1 + white: 9",
                               "red: 1 + white: 1", "red: 97% + black: 3%"})
      add(t, recipe, recipe, 1, noise);
    return t;
  }
};

TEST(JointFit, ExactDataGiveThePaintsBack) {
  Workshop lab;
  const SampleTable table = lab.table(0);
  const auto theory = two_flux_theory(lab.surface);
  JointSettings settings = JointSettings::plain();
  settings.noise = 1e-4;
  const JointFit fit(table, *theory, settings);
  EXPECT_TRUE(fit.palette().per_film);
  for (int p = 0; p < 2; ++p)
    for (std::size_t l = 0; l < lab.nm.size(); ++l) {
      const Pigment& found = fit.palette().pigments[*fit.palette().find(lab.names[std::size_t(p)])];
      EXPECT_NEAR(found.s[l] / lab.s(p, lab.nm[l]), 1, 2e-3) << found.name << lab.nm[l];
      EXPECT_NEAR(found.k[l] / lab.k(p, lab.nm[l]), 1, 2e-2) << found.name << lab.nm[l];
    }
  for (const SpecimenReport& r : fit.specimens()) EXPECT_LT(r.rms, 1e-5) << r.name;
}

/// Noise that the settings state is found again in the residuals, and so is noise that they do not state. With nothing
/// smooth, two unknowns a wavelength for each of three paints take 2 * 3 * 16 degrees of freedom.
TEST(JointFit, ResidualsTellTheNoise) {
  Workshop lab;
  SampleTable table = lab.table(0.002);
  for (const char* again : {"white again", "red again", "tint again"})
    lab.add(table, again,
            again[0] == 'w'   ? "white"
            : again[0] == 'r' ? "red"
                              : "red: 1 + white: 9",
            1, 0.002);
  const auto theory = two_flux_theory(lab.surface);
  JointSettings settings = JointSettings::plain();
  for (const double stated : {0.001, 0.002, 0.008}) {
    settings.noise = stated;
    const ResidualReport r = JointFit(table, *theory, settings).residuals();
    EXPECT_NEAR(r.values, 9 * 2 * 16, 1e-9);
    EXPECT_NEAR(r.freedom, 9 * 2 * 16 - 2 * 3 * 16, 8) << stated;
    EXPECT_NEAR(r.relative * stated, 0.002, 0.0003) << stated;
  }
}

/// Where the theory is exact, errors by the residuals cover the paints' K and S as 90 % intervals do, while a stated noise that is
/// larger than the measurements' makes errors that cover nearly all.
TEST(JointFit, ErrorsByResidualsAreRightForAnExactTheory) {
  int count = 0, by_residuals = 0, by_stated = 0;
  Workshop lab;
  const auto theory = two_flux_theory(lab.surface);
  for (int repeat = 0; repeat < 12; ++repeat) {
    const SampleTable table = lab.table(0.003);
    JointSettings settings = JointSettings::plain();
    settings.noise = 0.012;
    JointFit fit(table, *theory, settings);
    fit.with_errors();
    const ResidualReport residuals = fit.residuals();
    EXPECT_NEAR(residuals.relative, 0.25, 0.05);
    const std::vector<PaintErrors> stated = fit.errors(), errors = fit.errors(residuals.relative);
    for (const int paint : {0, 1}) {
      const std::size_t p = *fit.palette().find(lab.names[std::size_t(paint)]);
      const Pigment& found = fit.palette().pigments[p];
      for (std::size_t l = 0; l < lab.nm.size(); ++l, ++count) {
        const double off = std::abs(std::log(found.s[l] / lab.s(paint, lab.nm[l])));
        by_residuals += off < kNormal90 * errors[p].s[l], by_stated += off < kNormal90 * stated[p].s[l];
        EXPECT_NEAR(stated[p].s[l] * found.s[l], found.s_error[l], 1e-12 * found.s[l]);
      }
    }
    // Errors by another noise leave those by the stated one as they are.
    EXPECT_EQ(fit.errors()[0].k, stated[0].k);
  }
  EXPECT_NEAR(double(by_residuals) / count, 0.9, 0.07);
  EXPECT_GT(double(by_stated) / count, 0.99);
}

/// Repeats of one specimen over one card that scatter by 0.02 count less beside others than those that do not scatter.
TEST(JointFit, RepeatsThatScatterCountLess) {
  Workshop lab;
  const auto opaque = [&](double reflectance, const std::string& specimen) {
    Sample s;
    s.name = s.specimen = specimen, s.paints = parse_recipe("white"), s.backing = "opaque";
    s.values.assign(lab.nm.size(), reflectance);
    return s;
  };
  const auto mean_of = [&](double scatter) {
    SampleTable table{lab.nm, {}};
    for (const double sign : {-1., 1.}) table.samples.push_back(opaque(0.8 + sign * scatter, "scattered"));
    for (int i = 0; i < 2; ++i) table.samples.push_back(opaque(0.6, "steady"));
    const auto theory = two_flux_theory({});
    JointSettings settings = JointSettings::plain();
    settings.noise = 0.01;
    const JointFit fit(table, *theory, settings);
    const Pigment& p = fit.palette().pigments[0];
    return opaque_reflectance(p.k[0] / p.s[0]);
  };
  EXPECT_NEAR(mean_of(0), 0.7, 1e-3);
  // Repeats of 0.8 -+ 0.02 deviate by sqrt(2) 0.02; weights are 1/(0.01^2 + 0.0008) and 1/0.01^2.
  EXPECT_NEAR(mean_of(0.02), (0.8 / 9 + 0.6) / (1 / 9. + 1), 2e-3);
}

/// The palette of a fit mixes as the fit does: paints with unequal volumes per mass keep them.
TEST(JointFit, ThePaletteMixesAsTheFit) {
  Workshop lab;
  lab.volumes = {0.5, 1.6, 1.2};
  const SampleTable table = lab.table(0);
  const auto theory = two_flux_theory(lab.surface);
  JointSettings settings;
  settings.noise = 1e-4, settings.noise_relative = 0, settings.dose = 0, settings.thickness = 0;
  const JointFit fit(table, *theory, settings);
  Palette written = fit.palette();
  written.surface = lab.surface;
  std::istringstream text(palette_text(written));
  const Palette palette = read_palette(text);
  double worst = 0, by_mass = 0;
  for (const Sample& s : table.samples) {
    if (s.paints.empty()) continue;
    std::vector<double> fractions(palette.pigments.size());
    for (const Component& c : s.paints) fractions[*palette.find(c.name)] = c.fraction;
    const double card[] = {s.backing == "dark" ? 0.05 : 0.8};
    const auto mixed = paint_reflectance(mix(palette, fractions), 1, card, palette.surface);
    Palette masses = palette;
    masses.by_volume = false;
    const auto plain = paint_reflectance(mix(masses, fractions), 1, card, palette.surface);
    for (std::size_t l = 0; l < lab.nm.size(); ++l) {
      worst = std::max(worst, std::abs(mixed[l] - s.values[l]));
      by_mass = std::max(by_mass, std::abs(plain[l] - s.values[l]));
    }
  }
  EXPECT_LT(worst, 0.005);
  EXPECT_GT(by_mass, 0.03);  // without the volumes

  // A match finds the masses of a mixture again.
  const auto bell = [](double centre) {
    return [=](double nm) { return std::exp(-std::pow((nm - centre) / 40, 2)); };
  };
  const Observation lamp("equal energy", palette.nm, [](double) { return 1.0; },
                         {bell(600), bell(550), bell(450)});
  MatchTarget target;
  const double dark[] = {0.05};
  std::vector<double> fractions(3);
  fractions[*palette.find("red")] = 0.3, fractions[*palette.find("white")] = 0.7;
  target.reflectance = paint_reflectance(mix(palette, fractions), 1, dark, palette.surface);
  target.lab = lamp.lab(target.reflectance);
  MatchSettings match_settings;
  match_settings.max_paints = 2, match_settings.thickness = 1, match_settings.substrate = {0.05};
  const auto found = match(palette, target, lamp, {}, match_settings);
  ASSERT_FALSE(found.empty());
  for (std::size_t p = 0; p < 3; ++p) EXPECT_NEAR(found[0].fractions[p], fractions[p], 0.003);

  std::string missing = palette_text(written);
  missing.erase(missing.find("density white"),
                missing.find('\n', missing.find("density white")) + 1 - missing.find("density white"));
  std::istringstream without(missing);
  EXPECT_THROW(read_palette(without), TextError);
}

/// Errors of the fit are those of many repeated experiments, for quantities that the data determine.
TEST(JointFit, StatedErrorsAreTheSpreadOfExperiments) {
  Workshop lab;
  const auto theory = two_flux_theory(lab.surface);
  JointSettings settings = JointSettings::plain();
  settings.noise = 0.003;
  std::vector<double> z;
  for (int experiment = 0; experiment < 12; ++experiment) {
    const SampleTable table = lab.table(0.003);
    JointFit fit(table, *theory, settings);
    fit.with_errors();
    const Pigment& white = fit.palette().pigments[*fit.palette().find("white")];
    for (std::size_t l = 0; l < lab.nm.size(); ++l)
      z.push_back((std::log(white.s[l] / lab.s(0, lab.nm[l]))) / (white.s_error[l] / white.s[l]));
  }
  double sum = 0;
  for (const double v : z) sum += v * v;
  EXPECT_NEAR(std::sqrt(sum / double(z.size())), 1, 0.15);
}

TEST(JointFit, WhereAFilmHidesOnlyTheRatioIsKnown) {
  Workshop lab;
  SampleTable table{lab.nm, {}};
  lab.add_card(table, "dark", 0.05), lab.add_card(table, "light", 0.8);
  lab.add(table, "red", "red", 40, 0);
  const auto theory = two_flux_theory(lab.surface);
  JointFit fit(table, *theory);
  fit.with_errors();
  const Pigment& red = fit.palette().pigments[0];
  EXPECT_GT(red.s_error[2], 0.3 * red.s[2]);  // 440 nm
  EXPECT_LT(fit.ratio_error()[0][2], 0.25);
  EXPECT_NEAR(red.k[2] / red.s[2] / (lab.k(1, 440) / lab.s(1, 440)), 1, 0.1);
}

TEST(JointFit, FindsThicknessAmountsAndNamesAnOutlier) {
  Workshop lab;
  SampleTable table = lab.table(0.001);
  lab.add(table, "thick red", "red: 1 + white: 3", 1.3, 0.001);
  // Stated as 10 % of red, made with 13 %.
  lab.add(table, "strong", "red: 13 + white: 87", 1, 0.001);
  for (std::size_t s = table.samples.size() - 2; s < table.samples.size(); ++s)
    table.samples[s].paints = parse_recipe("red: 10 + white: 90");
  JointSettings settings;
  settings.noise = 0.002, settings.noise_relative = 0;
  const auto theory = two_flux_theory(lab.surface);
  const JointFit fit(table, *theory, settings);
  bool thick = false, strong = false;
  for (const SpecimenReport& r : fit.specimens()) {
    if (r.name == "thick red") {
      thick = true;
      EXPECT_NEAR(r.thickness, 1.3, 0.12);
    }
    if (r.name != "strong") continue;
    strong = true;
    double red = 0, white = 0;
    for (const SpecimenReport::Dose& d : r.doses) (d.paint == "red" ? red : white) = d.factor;
    EXPECT_NEAR(red / white, 0.13 / 0.87 * 9, 0.13);
  }
  EXPECT_TRUE(thick && strong);

  // A specimen that is another paint altogether is down-weighted, and the others stay.
  SampleTable wrong = lab.table(0.001);
  for (Sample& s : wrong.samples)
    if (s.specimen == "red: 1 + white: 1")
      for (double& v : s.values) v = std::min(1.0, 0.9 - 0.7 * v);
  const JointFit robust(wrong, *theory, settings);
  for (const SpecimenReport& r : robust.specimens())
    if (r.name == "red: 1 + white: 1") {
      EXPECT_LT(r.weight, 0.5);
      EXPECT_GT(r.rms, 0.02);
    }
}

TEST(JointFit, ACardThatWasNotMeasuredIsAnUnknown) {
  Workshop lab;
  SampleTable table = lab.table(0);
  table.samples.erase(table.samples.begin() + 1);  // the light card
  for (Sample& s : table.samples)
    if (s.backing == "light") s.backing = "white card";
  const auto theory = two_flux_theory(lab.surface);
  JointSettings settings;
  settings.noise = 0.001, settings.noise_relative = 0;
  const JointFit fit(table, *theory, settings);
  for (const SpecimenReport& r : fit.specimens()) EXPECT_LT(r.rms, 0.004) << r.name;
  EXPECT_EQ(fit.unknown_cards(), std::vector<std::string>{"white card"});
  ASSERT_EQ(joint_notes(fit).size(), 1u);
  // Nor do two cards that are alike pass in silence.
  SampleTable alike = lab.table(0);
  alike.samples[1].values = alike.samples[0].values;
  const auto notes = joint_notes(JointFit(alike, *theory, settings));
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("tell nothing of transmission"), std::string::npos);
}

/// A palette by streams, as a file, predicts by streams what the fit predicts: with equal mean cosines and with one for
/// each paint, of films and of opaque layers. By two fluxes it does not.
TEST(JointFit, APaletteByStreamsPredictsAsTheFit) {
  Workshop lab;
  lab.volumes = {0.5, 1.6, 1.2};
  const SampleTable table = lab.table(0);
  for (const double spread : {0.0, 0.3}) {
    const auto theory = streams_theory({.g = 0.7, .varies_g = spread > 0});
    JointSettings settings;
    settings.g = spread;
    const JointFit fit(table, *theory, settings);
    std::istringstream text(palette_text(fit.palette()));
    const Palette palette = read_palette(text);
    ASSERT_TRUE(palette.streams);
    EXPECT_EQ(palette.pigments[0].g.has_value(), spread > 0);
    const StreamsMixture mixture(palette);
    double off = 0;
    for (Sample s : table.samples) {
      if (s.paints.empty()) continue;
      std::vector<double> fractions(palette.pigments.size());
      for (const Component& c : s.paints) fractions[*palette.find(c.name)] = c.fraction;
      const double card = theory->card(outer_reflectance(lab.surface, s.backing == "dark" ? 0.05 : 0.8));
      const std::vector<double> film = mixture.reflectance(fractions, 1, std::vector<double>{card}),
                                by_fluxes = paint_reflectance(mix(palette, fractions), 1,
                                                              std::vector<double>{card}, lab.surface),
                                expected = fit.predict(s).values;
      s.backing = "opaque";
      const std::vector<double> opaque = mixture.reflectance(fractions, INFINITY, {}),
                                deep = fit.predict(s).values;
      for (std::size_t l = 0; l < lab.nm.size(); ++l) {
        EXPECT_NEAR(film[l], expected[l], 1e-9) << s.name << spread;
        EXPECT_NEAR(opaque[l], deep[l], 1e-9) << s.name << spread;
        off = std::max(off, std::abs(by_fluxes[l] - expected[l]));
      }
    }
    EXPECT_GT(off, 0.02);
  }
  EXPECT_THROW(StreamsMixture{kimera_fit().palette}, std::domain_error);
}

/// The light of a film over any card is the theory's reflectance, and within its interface a film of two fluxes has Kubelka
/// and Munk's R and T.
TEST(FilmTheory, LightOfAFilm) {
  const Surface surface = smooth_surface(1.5, Geometry::diffuse_8, Specular::included);
  const auto two = two_flux_theory(surface), streams = streams_theory({.g = 0.5}),
             with_g = streams_theory({.g = 0.5, .varies_g = true});
  for (const double k : {0.01, 0.4, 5.0})
    for (const double s : {0.1, 2.0, 20.0})
      for (const double shift : {-0.4, 0.0, 0.35}) {
        const FilmLayer film{std::log(k), std::log(s), shift};
        for (const FilmTheory* theory : {two.get(), streams.get(), with_g.get()}) {
          for (const double card : {0.0, 0.3, 1.0})
            EXPECT_NEAR(theory->light(film).over(card), theory->over(film, card).value, 1e-12)
                << theory->name() << k << " " << s;
          EXPECT_NEAR(theory->opaque_value(film), theory->opaque(film).value, 1e-12) << theory->name();
        }
        const InnerFilm inner = inner_film(two->light(film), surface);
        const LayerTransfer expected = layer({k, s}, 1);
        EXPECT_NEAR(inner.reflectance, expected.reflectance, 1e-12);
        EXPECT_NEAR(inner.back, expected.reflectance, 1e-12);
        EXPECT_NEAR(inner.transmittance2, expected.transmittance * expected.transmittance, 1e-12);
      }
}

/// Layers whose K/S is at the corner of the tables, where both K and S are largest, are as opaque as all others.
TEST(FilmTheory, OpaqueLayersOfStreams) {
  const auto theory = streams_theory({.g = 0.7});
  constexpr double kStep = 1e-4;
  for (double ratio = -4; ratio < 3; ratio += 0.03) {
    const double ln_s = std::min(6.9, 4.9 - ratio);  // a film that nothing shows through
    EXPECT_NEAR(theory->opaque({ratio, 0}).value, theory->over({ln_s + ratio, ln_s}, 0).value, 1e-4) << ratio;
    EXPECT_NEAR(
        theory->opaque({ratio, 0}).by_ln_k,
        (theory->opaque({ratio + kStep, 0}).value - theory->opaque({ratio - kStep, 0}).value) / (2 * kStep),
        1e-4)
        << ratio;
  }
}

/// Paths of photons through a slab of index 1.5 in air, by Fresnel's equations and Henyey and Greenstein's phase function: the
/// fraction that leaves above after scattering, and the fraction that leaves below.
struct SlabPaths {
  double reflected = 0, transmitted = 0;

  SlabPaths(double sigma_a, double sigma_s, double g, double outer_cosine, int count, unsigned seed) {
    constexpr double kIndex = 1.5;
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    // Fresnel's reflectance from inside the slab, for a cosine within.
    const auto inside = [](double cosine) {
      const double sine2 = kIndex * kIndex * (1 - cosine * cosine);
      if (sine2 >= 1) return 1.0;
      const double out = std::sqrt(1 - sine2), s = (kIndex * cosine - out) / (kIndex * cosine + out),
                   p = (cosine - kIndex * out) / (cosine + kIndex * out);
      return (s * s + p * p) / 2;
    };
    const double entered = std::sqrt(1 - (1 - outer_cosine * outer_cosine) / (kIndex * kIndex));
    for (int i = 0; i < count; ++i) {
      double z = 0, mu = entered;
      bool scattered = false;
      if (uniform(random) < inside(entered)) continue;  // gloss, which is excluded
      for (;;) {
        const double step = -std::log(1 - uniform(random)) / (sigma_a + sigma_s), to = z + step * mu;
        if (to >= 0 && to <= 1) {
          z = to;
          if (uniform(random) * (sigma_a + sigma_s) < sigma_a) break;
          const double part = (1 - g * g) / (1 - g + 2 * g * uniform(random)),
                       cosine = g == 0 ? 2 * uniform(random) - 1 : (1 + g * g - part * part) / (2 * g);
          mu = mu * cosine +
               std::sqrt((1 - mu * mu) * (1 - cosine * cosine)) * std::cos(2 * M_PI * uniform(random));
          scattered = true;
          continue;
        }
        z = to < 0 ? 0 : 1;
        if (uniform(random) >= inside(std::abs(mu))) {
          if (z == 1)
            transmitted += 1.0 / count;
          else if (scattered)
            reflected += 1.0 / count;
          break;
        }
        mu = -mu;
      }
    }
  }
};

/// Free films of streams are those of photons that are followed: reflectance without gloss, and all transmitted light.
TEST(FilmTheory, FreeFilmsOfStreamsArePaths) {
  constexpr int kPaths = 200000;
  const StreamsSettings settings{.index = 1.5, .g = 0.7};
  const auto theory = streams_theory(settings);
  for (const auto& [k, s] : {std::pair{0.02, 0.1}, {0.5, 1.0}, {0.05, 4.0}, {2.0, 0.3}}) {
    const FilmLayer film{std::log(k), std::log(s)};
    const SlabPaths paths(k / 2, 4. / 3 * s / 0.3, 0.7, std::cos(8 * M_PI / 180), kPaths, 11);
    // Four standard deviations, and the error of the tables and of 16 streams.
    const auto margin = [](double p) { return 4 * std::sqrt(p * (1 - p) / kPaths) + 1e-3; };
    EXPECT_NEAR(theory->free_reflectance(film).value, paths.reflected, margin(paths.reflected))
        << k << " " << s;
    EXPECT_NEAR(theory->free_transmittance(film).value, paths.transmitted, margin(paths.transmitted))
        << k << " " << s;
    constexpr double kStep = 1e-4;
    for (const bool by_k : {true, false}) {
      FilmLayer more = film, less = film;
      (by_k ? more.ln_k : more.ln_s) += kStep, (by_k ? less.ln_k : less.ln_s) -= kStep;
      const FilmValue r = theory->free_reflectance(film), t = theory->free_transmittance(film);
      EXPECT_NEAR(by_k ? r.by_ln_k : r.by_ln_s,
                  (theory->free_reflectance(more).value - theory->free_reflectance(less).value) / (2 * kStep),
                  1e-5);
      EXPECT_NEAR(
          by_k ? t.by_ln_k : t.by_ln_s,
          (theory->free_transmittance(more).value - theory->free_transmittance(less).value) / (2 * kStep),
          1e-5);
    }
  }
  // Gloss: 4 % of each of two surfaces, of which a nearly clear film shows both.
  StreamsSettings with_gloss = settings;
  with_gloss.specular = Specular::included;
  const FilmLayer clear{std::log(1e-4), std::log(1e-3)};
  EXPECT_NEAR(
      streams_theory(with_gloss)->free_reflectance(clear).value - theory->free_reflectance(clear).value,
      2 * 0.04 / 1.04, 2e-3);
}

/// K and S of free films, measured in R and T at two thicknesses, come back from a joint fit by streams; by two fluxes they
/// do not.
TEST(JointFit, FreeFilmsByStreams) {
  SampleTable table;
  for (double l = 400; l <= 700; l += 50) table.nm.push_back(l);
  const auto k = [](double l) { return 1e5 * (0.02 + 0.6 / (1 + std::exp((l - 560) / 20))); };
  const auto s = [](double l) { return 4e4 * 550 / l; };
  for (const double thickness : {10e-6, 30e-6})
    for (const auto quantity : {Sample::Quantity::reflectance, Sample::Quantity::transmittance}) {
      Sample& one = table.samples.emplace_back();
      one.name = "film", one.paints = parse_recipe("ink"), one.backing = "none", one.states_backing = true;
      one.quantity = quantity, one.thickness = thickness;
      for (const double l : table.nm) {
        optics::StackDescription d;
        d.layers = {
            {k(l) / 2, 4. / 3 * s(l) / 0.3, thickness, optics::LegendrePhase::henyey_greenstein(0.7), 1.5}};
        const optics::StackFluxes f =
            optics::PlaneStack(d, {32}).fluxes(optics::StackLight::beam(std::cos(8 * M_PI / 180)));
        one.values.push_back(quantity == Sample::Quantity::transmittance
                                 ? f.transmittance
                                 : f.reflectance - f.unscattered_reflectance);
      }
    }
  JointSettings settings;
  settings.noise = 0.001, settings.noise_relative = 0.002;
  const auto worst = [&](const FilmTheory& theory) {
    const JointFit fit(table, theory, settings);
    const Pigment& ink = fit.palette().pigments[0];
    double off = 0;
    for (std::size_t l = 0; l < table.nm.size(); ++l)
      off = std::max({off, std::abs(ink.k[l] / k(table.nm[l]) - 1), std::abs(ink.s[l] / s(table.nm[l]) - 1)});
    return off;
  };
  EXPECT_LT(worst(*streams_theory({.index = 1.5, .g = 0.7})), 0.04);
  EXPECT_GT(worst(*two_flux_theory(smooth_surface(1.5, Geometry::diffuse_8, Specular::excluded))), 0.2);
}

/// The table of opaque layers by the reflectance of two fluxes, which searches use, is the theory.
TEST(FilmTheory, OpaqueReflectanceOfSearches) {
  const auto streams = streams_theory({.g = 0.7}),
             two = two_flux_theory(saunderson_surface(0.04, 0.6, Specular::included));
  for (const FilmTheory* theory : {streams.get(), two.get()}) {
    const OpaqueReflectance opaque(*theory);
    for (double ratio = -11; ratio < 6; ratio += 0.037)
      EXPECT_NEAR(opaque(2 * std::exp(ratio), 2), theory->opaque({ratio, 0}).value, 1e-5)
          << theory->name() << ratio;
    EXPECT_NEAR(opaque(0, 1), theory->opaque({-30, 0}).value, 1e-4);
    EXPECT_NEAR(opaque(1, 0), theory->opaque({30, 0}).value, 1e-4);
  }
}

/// Recipes of a palette by streams are those that streams predict: opaque and as films, with mean cosines of the paints.
TEST(PigmentMatch, ByStreams) {
  Palette palette;
  for (int nm = 400; nm <= 700; nm += 20) palette.nm.push_back(nm);
  const auto paint = [&](const std::string& name, double edge, double s, double g) {
    Pigment& p = palette.pigments.emplace_back();
    p.name = name, p.g = g;
    for (const double nm : palette.nm)
      p.k.push_back(0.01 + (edge > 0 ? 6 / (1 + std::exp((nm - edge) / 15)) : 0)), p.s.push_back(s);
  };
  paint("white", 0, 8, 0.6), paint("red", 590, 2, 0.75), paint("yellow", 500, 3, 0.8);
  palette.relative = palette.per_film = true;
  palette.streams = PaletteStreams{.index = 1.5, .g = 0.7};
  const StreamsMixture streams(palette);
  const auto lobe = [](double centre) {
    return [centre](double nm) { return std::exp(-std::pow((nm - centre) / 40, 2)); };
  };
  const Observation lamp("equal energy", palette.nm, [](double) { return 1; },
                         {lobe(600), lobe(550), lobe(450)});
  const std::vector<double> fractions{0.7, 0.1, 0.2};
  for (const double thickness : {1.0, double(INFINITY)}) {
    MatchSettings settings;
    settings.thickness = thickness, settings.substrate = {0.5}, settings.by = MatchBy::spectrum;
    MatchTarget target;
    target.reflectance = streams.reflectance(fractions, thickness, settings.substrate);
    target.lab = lamp.lab(target.reflectance);
    const std::vector<Match> found = match(palette, target, lamp, {}, settings);
    ASSERT_FALSE(found.empty());
    for (std::size_t p = 0; p < 3; ++p) EXPECT_NEAR(found[0].fractions[p], fractions[p], 2e-3) << thickness;
    EXPECT_LT(found[0].rms, 1e-4);
    // By two fluxes the same K and S have another colour.
    Palette by_fluxes = palette;
    by_fluxes.streams.reset();
    EXPECT_GT(match(by_fluxes, target, lamp, {}, settings)[0].rms, 1e-3);
  }
}

/// Two measurements that depend on K and S in different ways tell them apart; less does not.
TEST(JointFit, WhatTellsAPaint) {
  Workshop lab;
  const auto unknown = [&](const std::vector<std::tuple<std::string, double, std::string>>& films) {
    SampleTable table{lab.nm, {}};
    for (const auto& [name, inner] : {std::pair{"dark", 0.05}, {"light", 0.8}, {"bright", 0.82}})
      lab.add_card(table, name, inner);
    for (const auto& [backing, thickness, recipe] : films) {
      Sample s;
      s.name = recipe + " over " + backing, s.specimen = std::to_string(table.samples.size());
      s.paints = parse_recipe(recipe), s.backing = backing, s.thickness = 1e-6 * thickness;
      for (const double l : lab.nm)
        s.values.push_back(backing == "opaque"
                               ? 0.3
                               : lab.reflectance(s.paints, l, thickness > 0 ? thickness / 20 : 1,
                                                 backing == "dark" ? 0.05 : 0.8));
      table.samples.push_back(s);
    }
    const auto theory = two_flux_theory(lab.surface);
    JointFit fit(table, *theory);
    const std::vector<UnknownPaint> all = fit.unknown_paints();
    fit.with_errors();
    const Pigment& red = fit.palette().pigments[*fit.palette().find("red")];
    const bool is_wide = red.k_error[0] > 100 * red.k[0] && red.s_error[0] > 100 * red.s[0];
    EXPECT_EQ(is_wide, !all.empty() && !all[0].ratio_is_known);
    return all.empty() ? "" : all[0].name + (all[0].ratio_is_known ? ": K/S" : ": nothing");
  };
  EXPECT_EQ(unknown({{"dark", 20, "red"}}), "red: nothing");
  EXPECT_EQ(unknown({{"dark", 20, "red"}, {"dark", 20.5, "red"}}), "red: nothing");
  EXPECT_EQ(unknown({{"light", 20, "red"}, {"bright", 20, "red"}}), "red: nothing");
  EXPECT_EQ(unknown({{"opaque", 0, "red"}}), "red: K/S");
  EXPECT_EQ(unknown({{"opaque", 0, "red"}, {"dark", 20, "red"}}), "");
  EXPECT_EQ(unknown({{"dark", 20, "red"}, {"light", 20, "red"}}), "");
  EXPECT_EQ(unknown({{"dark", 20, "red"}, {"dark", 40, "red"}}), "");
  EXPECT_EQ(unknown({{"dark", 20, "red"}, {"dark", 20, "red: 1 + white: 1"}, {"light", 20, "white"}}), "");
}

/// Films that streams make, with grains of other g than the fit assumes, and noise: a mixture that no fit has seen.
TEST(JointFit, SyntheticFilmsArePredicted) {
  std::vector<double> nm;
  for (double l = 400; l <= 700; l += 20) nm.push_back(l);
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, 0.002);
  struct Grain {
    double k, s, g;
  };
  const auto paint = [](int p, double l) -> Grain {
    const double fall = std::pow(550 / l, 1.3);
    if (p == 0) return {0.01, 6 * fall, 0.55};
    if (p == 1) return {0.05 + 6 / (1 + std::exp((l - 580) / 15)), 1.5, 0.7};
    return {0.05 + 5 / (1 + std::exp((520 - l) / 15)), 0.8 * fall, 0.3};
  };
  const auto film = [&](const std::vector<Component>& recipe, double l, double card) {
    double k = 0, s = 0, first = 0, scattering = 0;
    for (const Component& c : recipe) {
      const Grain g = paint(c.name == "white" ? 0 : c.name == "red" ? 1 : 2, l);
      k += c.fraction * g.k, s += c.fraction * g.s;
      scattering += c.fraction * g.s / (1 - g.g), first += c.fraction * g.s / (1 - g.g) * g.g;
    }
    return diffuse_film(k, s, first / scattering, 1.5, card);
  };
  SampleTable table{nm, {}};
  const auto add = [&](const std::string& recipe) {
    for (const double card : {0.05, 0.8}) {
      Sample s;
      s.name = recipe, s.specimen = recipe, s.backing = card < 0.5 ? "0.05" : "0.8",
      s.paints = parse_recipe(recipe);
      for (const double l : nm) s.values.push_back(std::max(0.0, film(s.paints, l, card) + noise(random)));
      table.samples.push_back(s);
    }
  };
  for (const char* recipe : {"white", "red", "blue", "red: 1 + white: 9", "blue: 1 + white: 9",
                             "red: 1 + white: 1", "red: 1 + blue: 2 + white: 7"})
    add(recipe);
  JointSettings settings;
  settings.noise = 0.004, settings.noise_relative = 0.01;
  JointSettings settings_g = settings;
  settings_g.g = 0.4;
  double rms[3] = {};
  const auto two = two_flux_theory(smooth_surface(1.5, Geometry::diffuse_diffuse, Specular::excluded));
  const auto streams = streams_theory({.index = 1.5, .g = 0.5, .geometry = Geometry::diffuse_diffuse});
  const auto streams_g = streams_theory(
      {.index = 1.5, .g = 0.5, .geometry = Geometry::diffuse_diffuse, .varies_g = true}, std_thread_for());
  for (const int t : {0, 1, 2}) {
    const FilmTheory& theory = t == 0 ? *two : t == 1 ? *streams : *streams_g;
    const JointSettings& set = t == 2 ? settings_g : settings;
    const JointFit full(table, theory, set);
    const auto held = hold_out(table, theory, set, {{"red: 1 + blue: 2 + white: 7"}}, full, true);
    const std::vector<MeanCosine> cosines = full.mean_cosines();
    ASSERT_EQ(cosines.size(), t == 2 ? 3u : 0u);
    for (std::size_t p = 0; p < cosines.size(); ++p) {
      const std::string& name = full.palette().pigments[p].name;
      const double truth = name == "white" ? 0.55 : name == "red" ? 0.7 : 0.3;
      std::printf("%s: g %.3f +- %.3f, made with %.2f\n", name.c_str(), cosines[p].g, cosines[p].error,
                  truth);
      EXPECT_NEAR(cosines[p].g, truth, 3 * cosines[p].error) << name;
    }
    ASSERT_EQ(held.size(), 1u);
    ASSERT_EQ(held[0].predictions.size(), 2u) << held[0].reason;
    int inside = 0, count = 0;
    for (std::size_t i = 0; i < 2; ++i)
      for (std::size_t l = 0; l < nm.size(); ++l, ++count) {
        const double difference =
            held[0].predictions[i].values[l] - table.samples[held[0].samples[i]].values[l];
        rms[t] += difference * difference / double(2 * nm.size());
        inside += std::abs(difference) < 1.645 * held[0].predictions[i].error[l];
      }
    if (t > 0) {
      EXPECT_GE(inside, 0.8 * count);
    }
  }
  std::printf(
      "a mixture of three, kept back: rms of R %.4f by two fluxes, %.4f by streams of one g, %.4f of each paint's g\n",
      std::sqrt(rms[0]), std::sqrt(rms[1]), std::sqrt(rms[2]));
  EXPECT_LT(std::sqrt(rms[2]), 0.008);
  EXPECT_LT(std::sqrt(rms[1]), 0.008);
  EXPECT_LT(rms[1], rms[0]);
}

TEST(JointFit, SaysThatItDidNotConverge) {
  Workshop lab;
  const SampleTable table = lab.table(0);
  const auto two = two_flux_theory(lab.surface);
  EXPECT_TRUE(JointFit(table, *two).converged());
  JointSettings settings;
  settings.iterations = 1;
  const JointFit fit(table, *two, settings);
  EXPECT_FALSE(fit.converged());
  const std::vector<std::string> notes = joint_notes(fit);
  EXPECT_TRUE(std::any_of(notes.begin(), notes.end(), [](const std::string& n) {
    return n.find("did not converge") != std::string::npos;
  }));
  // A table of twice the specimens takes longer, by at most the cube and at least in proportion.
  SampleTable twice = table;
  for (Sample s : table.samples)
    if (!s.paints.empty()) s.specimen = specimen_key(s) + " again", twice.samples.push_back(s);
  const double ratio = joint_fit_seconds(twice) / joint_fit_seconds(table);
  EXPECT_GT(ratio, 1.5);
  EXPECT_LT(ratio, 8);
}

TEST(JointFit, BadInputIsNamed) {
  Workshop lab;
  SampleTable table = lab.table(0);
  const auto two = two_flux_theory(lab.surface);
  EXPECT_THROW(hold_out(table, *two, {}, {{"rde"}}, JointFit(table, *two), false), std::domain_error);
  Sample other = table.samples.back();
  other.paints = parse_recipe("white");
  table.samples.push_back(other);
  EXPECT_THROW(JointFit(table, *two), SampleError);  // one specimen, two recipes
  // An opaque layer and a film over a card have no transmittance; a free film does.
  table.samples.back().specimen = "film", table.samples.back().quantity = Sample::Quantity::transmittance;
  for (const char* backing : {"opaque", "0.3"}) {
    table.samples.back().backing = backing;
    EXPECT_THROW(JointFit(table, *two), SampleError) << backing;
  }
  table.samples.back().backing = "none";
  EXPECT_NO_THROW(JointFit(table, *two));
  EXPECT_THROW(in_groups(table, 1), std::domain_error);
}

}  // namespace
}  // namespace aureole::pigment
