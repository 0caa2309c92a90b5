// SPDX-License-Identifier: Apache-2.0
// The outcome of a check of a scattering function: one finding per thing that was tested, and the numbers
// behind them.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "aureole/math/vec.h"
#include "aureole/spectrum/spectrum.h"

namespace aureole {

/// Each rule has a file of its own in this folder, named after it.
enum class CheckRule {
  sample,            ///< `sample` returns the value and density of `eval_pdf`
  chi_square,        ///< samples follow the density
  delta_lobes,       ///< delta lobes occur as often as their mass says
  density_integral,  ///< densities, masses and failures add up to one
  energy,            ///< no energy is gained, and none lost where the options say so
  sample_energy,     ///< samples carry the energy that `eval` has
  black,             ///< from below, where that is asked for
  wavelengths,       ///< rotating which wavelength is the hero rotates values and densities
  modes,             ///< importance mode is radiance mode with the directions exchanged
  reciprocity,
  finite,  ///< valid numbers everywhere, at grazing and at the ends of the random numbers, too
};
const char* name_of(CheckRule rule);

/// One thing that was tested, for one direction and hero where it depends on them.
struct CheckFinding {
  CheckRule rule = CheckRule::sample;
  Vec3 wi = {};   ///< zero: many directions
  double nm = 0;  ///< zero: all wavelengths
  /// The measured number: chi-square, frequency, integral, energy, or else the largest relative deviation.
  double figure = 0;
  double expected = 0;
  double p_value = -1;  ///< of a statistical test; else negative
  double limit = 0;     ///< least p-value, or else the largest difference between figure and expectation
  bool passed = true;
  std::string message = {};  ///< a sentence, where it did not pass
};

struct CheckResult {
  struct Energy {
    Vec3 wi;
    std::array<double, kWavelengths> nm{}, energy{};
    bool bounded = true;  ///< `largest_energy` is its bound
  };
  struct Bin {
    Vec3 center;
    float size = 0, expected = 0, found = 0;
  };
  struct Histogram {
    Vec3 wi;
    double nm = 0;
    int hero = 0;
    std::size_t samples = 0;
    double p_value = 1, chi_square = 0;
    std::size_t pools = 0;  ///< bins of the test, made of these bins
    std::vector<Bin> bins;
  };
  /// f / n_o^2 in radiance mode for light that arrives from wo, and the same with the directions exchanged.
  struct Pair {
    Vec3 wi, wo;
    double nm = 0, forward = 0, backward = 0;
  };

  std::vector<CheckFinding> findings;
  std::vector<Energy> energies;
  std::vector<Histogram> histograms;
  std::vector<Pair> pairs;
  double level = 0;  ///< least p-value of a single test
  std::size_t statistical_tests = 0;
  double smallest_p = 1, largest_energy = 0, smallest_energy = 1, largest_mass_error = 0;
  double largest_failure = 0;  ///< part of the samples that had no direction, at most
  bool black_below = false;    ///< as found

  bool passed() const;
  std::vector<std::string> problems() const;  ///< sentences; empty where all is well
};

}  // namespace aureole
