// SPDX-License-Identifier: Apache-2.0
// Intensity of a layer by brute force: the waves of all scatterers of simulated arrangements, added up one by
// one, against the J(q) that structure factors of other, independent simulations predict. Radii in units of
// the correlation radius; intensities per scatterer.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "aureole/optics/arrangement/hard_discs.h"
#include "aureole/optics/arrangement/simulated_structure_factor.h"
#include "harness/effort.h"
#include "harness/phasors.h"

namespace aureole::optics {
namespace {

using test::Phasors;

constexpr double kPi = std::numbers::pi;

struct Wave {
  double x, y;
  double length() const { return std::hypot(x, y); }
};

/// Wave vectors with the period of the box, to which its mean density contributes nothing, in 0.2 < |q| < 6,
/// `count` in each of 40 rings.
std::vector<std::vector<Wave>> box_waves(double box, int count) {
  std::vector<std::vector<Wave>> rings;
  for (int r = 0; r < 40; ++r) {
    const double q = 0.27 + (5.93 - 0.27) * r / 39;
    rings.emplace_back();
    for (int i = 0; i < count; ++i) {
      const double angle = kPi * (i + 0.37) / count, step = 2 * kPi / box;
      rings.back().push_back(
          {step * std::round(q * std::cos(angle) / step), step * std::round(q * std::sin(angle) / step)});
    }
  }
  return rings;
}

double circle(const Wave& q, double radius) {
  const double u = q.length() * radius;
  return kPi * radius * radius * (u < 1e-6 ? 1 : 2 * ::j1(u) / u);
}

double square(const Wave& q, double side) {
  const auto sinc = [](double x) { return std::abs(x) < 1e-6 ? 1 : std::sin(x) / x; };
  return side * side * sinc(q.x * side / 2) * sinc(q.y * side / 2);
}

/// Kinds of scatterers; each disc is given one at random, with equal probabilities.
struct Layer {
  std::string name;
  std::vector<std::function<double(const Wave&)>> kinds;
};

/// Difference of two ring means of a layer's intensity.
struct Difference {
  double rms = 0, worst = 0;  // of the largest intensity
};
Difference difference(const std::vector<double>& a, const std::vector<double>& truth) {
  const double largest = *std::max_element(truth.begin(), truth.end());
  Difference d;
  for (size_t r = 0; r < a.size(); ++r) {
    const double e = (a[r] - truth[r]) / largest;
    d.rms += e * e / double(a.size());
    if (std::abs(e) > std::abs(d.worst)) d.worst = e;
  }
  d.rms = std::sqrt(d.rms);
  return d;
}

void report(const std::string& name, double fa, const Difference& simulated, const Difference& theory,
            const char* theory_name) {
  std::printf("%-28s Fa %.2f: J with simulated S rms %.2f %%, worst %+.2f %%; with %s %.2f %%, %+.2f %%\n",
              name.c_str(), fa, 100 * simulated.rms, 100 * simulated.worst, theory_name, 100 * theory.rms,
              100 * theory.worst);
}

/// sum_i F_i exp(-i q.r_i) of several sets of amplitudes at once, [wave of the ring][layer].
void label_test(double fa, const std::vector<Layer>& layers, int snapshots) {
  HardDiscSimulation simulation(900, fa, 4711);
  simulation.advance(simulation.equilibration_sweeps());
  const HardDiscs& discs = simulation.state();
  const int n = discs.size();
  const auto rings = box_waves(discs.box_x, 12);
  std::vector<std::vector<double>> truth(layers.size(), std::vector<double>(rings.size()));
  std::uint64_t counter = 0;
  std::vector<std::vector<int>> label(layers.size(), std::vector<int>(n));
  for (int s = 0; s < snapshots; ++s) {
    simulation.advance(2 * simulation.decorrelation_sweeps());
    for (size_t k = 0; k < layers.size(); ++k)
      for (int& l : label[k]) l = int(combine_bits(99, counter++) % std::uint64_t(layers[k].kinds.size()));
    const Phasors phasors(discs.x, discs.y, discs.box_x);
    for (size_t r = 0; r < rings.size(); ++r)
      for (const Wave& q : rings[r]) {
        std::vector<std::vector<double>> amplitude;
        for (const Layer& layer : layers) {
          amplitude.emplace_back();
          for (const auto& f : layer.kinds) amplitude.back().push_back(f(q));
        }
        std::vector<double> re(layers.size()), im(layers.size());
        const auto wave = phasors.of(q.x, q.y);
        for (int i = 0; i < n; ++i) {
          const std::complex<double> phasor = wave(size_t(i));
          const double c = phasor.real(), d = phasor.imag();
          for (size_t k = 0; k < layers.size(); ++k)
            re[k] += amplitude[k][label[k][i]] * c, im[k] -= amplitude[k][label[k][i]] * d;
        }
        for (size_t k = 0; k < layers.size(); ++k)
          truth[k][r] += (re[k] * re[k] + im[k] * im[k]) / (double(n) * double(rings[r].size()) * snapshots);
      }
  }

  HardDiscEnsemble ensemble;
  ensemble.seed = 17, ensemble.snapshots = test::effort(400, 900);
  const SimulatedStructureFactor simulated(fa, ensemble);
  for (size_t k = 0; k < layers.size(); ++k) {
    const auto predict = [&](const std::function<double(double)>& s) {
      std::vector<double> mean(rings.size());
      for (size_t r = 0; r < rings.size(); ++r)
        for (const Wave& q : rings[r]) {
          double squares = 0, sum = 0;
          for (const auto& f : layers[k].kinds) squares += f(q) * f(q), sum += f(q);
          const double p = 1.0 / double(layers[k].kinds.size());
          squares *= p, sum *= p;
          mean[r] += ((squares - sum * sum) + sum * sum * s(q.length())) / double(rings[r].size());
        }
      return mean;
    };
    const Difference with_simulated =
        difference(predict([&](double u) { return simulated.eval(u); }), truth[k]);
    const Difference with_theory =
        difference(predict([&](double u) { return hard_disc_structure_factor(u, fa); }), truth[k]);
    report(layers[k].name, fa, with_simulated, with_theory, "Percus-Yevick");
    EXPECT_LT(with_simulated.rms, 0.02) << layers[k].name;
    EXPECT_LT(std::abs(with_simulated.worst), 0.06) << layers[k].name;
    // The arrangement matters: random positions would be far off.
    EXPECT_GT(difference(predict([](double) { return 1.0; }), truth[k]).rms, 0.1) << layers[k].name;
  }
}

std::vector<Layer> all_layers() {
  const auto unit = [](const Wave& q) { return circle(q, 1); };
  return {{"circles", {unit}},
          {"circles of radii 1 and 0.6", {unit, [](const Wave& q) { return circle(q, 0.6); }}},
          {"circles and squares",
           {[](const Wave& q) { return circle(q, 0.9); }, [](const Wave& q) { return square(q, 1.4); }}}};
}

TEST(WaveSum, LabelledMixtures) {
  if (test::is_thorough()) label_test(0.5, all_layers(), 260);
  label_test(0.62, all_layers(), test::effort(120, 260));
}

TEST(WaveSum, Polydisperse) {
  const double fa = 0.5;
  const HardDiscMixture mixture({0.6, 1.0, 1.5}, {0.3, 0.5, 0.2}, fa);
  HardDiscEnsemble ensemble;
  ensemble.seed = 23, ensemble.snapshots = test::effort(300, 700), ensemble.discs = 1000;
  const PartialStructureFactors simulated = simulate_partial_structure_factors(mixture, ensemble);
  const PartialStructureFactors theory(mixture, 40);
  EXPECT_LT(simulated.chi_squared(), 1.3);

  std::vector<double> radii;
  for (int m = 0; m < 3; ++m)
    radii.insert(radii.end(), int(std::round(1000 * mixture.fraction(m))), mixture.radius(m));
  HardDiscSimulation simulation(radii, fa, 815);
  simulation.advance(simulation.equilibration_sweeps());
  const HardDiscs& discs = simulation.state();
  const auto rings = box_waves(discs.box_x, 12);
  std::vector<double> truth(rings.size());
  const int snapshots = test::effort(150, 350), n = discs.size();
  for (int s = 0; s < snapshots; ++s) {
    simulation.advance(2 * simulation.decorrelation_sweeps());
    const Phasors phasors(discs.x, discs.y, discs.box_x);
    for (size_t r = 0; r < rings.size(); ++r)
      for (const Wave& q : rings[r]) {
        const double f[3] = {circle(q, 0.6), circle(q, 1.0), circle(q, 1.5)};
        double re = 0, im = 0;
        const auto wave = phasors.of(q.x, q.y);
        for (int i = 0; i < n; ++i) {
          const std::complex<double> phasor = wave(size_t(i));
          const double amplitude = f[discs.radius[i] < 0.8 ? 0 : discs.radius[i] < 1.2 ? 1 : 2];
          re += amplitude * phasor.real(), im -= amplitude * phasor.imag();
        }
        truth[r] += (re * re + im * im) / (double(n) * double(rings[r].size()) * snapshots);
      }
  }
  const auto predict = [&](const std::function<double(int, int, double)>& s) {
    std::vector<double> mean(rings.size());
    for (size_t r = 0; r < rings.size(); ++r)
      for (const Wave& q : rings[r])
        for (int m = 0; m < 3; ++m)
          for (int l = 0; l < 3; ++l)
            mean[r] += std::sqrt(mixture.fraction(m) * mixture.fraction(l)) * circle(q, mixture.radius(m)) *
                       circle(q, mixture.radius(l)) * s(m, l, q.length()) / double(rings[r].size());
    return mean;
  };
  const Difference with_simulated =
      difference(predict([&](int m, int l, double q) { return simulated.eval(m, l, q); }), truth);
  const Difference with_theory =
      difference(predict([&](int m, int l, double q) { return theory.eval(m, l, q); }), truth);
  report("discs of three sizes", fa, with_simulated, with_theory, "Rosenfeld");
  EXPECT_LT(with_simulated.rms, 0.02);
  // Sizes labelled at random on one set of equal discs give another intensity.
  EXPECT_GT(difference(predict([&](int m, int l, double q) {
                         const double s = hard_disc_structure_factor(q * 1.5, fa);
                         return (m == l) + std::sqrt(mixture.fraction(m) * mixture.fraction(l)) * (s - 1);
                       }),
                       truth)
                .rms,
            0.05);
}

}  // namespace
}  // namespace aureole::optics
