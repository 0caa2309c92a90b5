// SPDX-License-Identifier: Apache-2.0
// The result of a check of a scattering function: one finding per test, and the data behind the findings.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "aureole/math/vec.h"
#include "aureole/spectrum/spectrum.h"

namespace aureole {

/// The rules. Each is implemented in a file of this folder, named after it.
enum class CheckRule {
  sample,            ///< `sample` returns the value and pdf of `eval_pdf`
  chi_square,        ///< samples follow the pdf
  delta_lobes,       ///< frequencies of delta lobes agree with their probability masses
  density_integral,  ///< pdfs, masses and failures sum to one
  energy,            ///< no energy is gained, and none is lost if the options exclude it
  sample_energy,     ///< the mean sample weight equals the energy of `eval`
  black,             ///< nothing is scattered from below, if the options require it
  wavelengths,       ///< choosing another hero permutes values and pdfs accordingly
  modes,             ///< importance mode is radiance mode with the directions exchanged
  reciprocity,
  finite,  ///< valid numbers everywhere, also at grazing incidence and for extreme random numbers
};
const char* name_of(CheckRule rule);

/// The result of one test, for one direction and hero wavelength if it depends on them.
struct CheckFinding {
  CheckRule rule = CheckRule::sample;
  Vec3 wi = {};   ///< direction of incidence; zero: many directions
  double nm = 0;  ///< hero wavelength; zero: all wavelengths
  /// The measured number: chi-square, frequency, integral, energy, or else the largest relative deviation.
  double figure = 0;
  double expected = 0;
  double p_value = -1;  ///< p-value of a statistical test; negative for other tests
  double limit = 0;     ///< smallest accepted p-value, or else the largest accepted difference from
                        ///< `expected`
  bool passed = true;
  std::string message = {};  ///< a sentence about the failure, if the test failed
};

struct CheckResult {
  struct Energy {
    Vec3 wi;
    std::array<double, kWavelengths> nm{}, energy{};
    bool bounded = true;  ///< whether `largest_energy` applies
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
    std::size_t pools = 0;  ///< number of pooled bins of the test
    std::vector<Bin> bins;
  };
  /// f / n_o^2 in radiance mode for light arriving from wo, and the value with exchanged directions.
  struct Pair {
    Vec3 wi, wo;
    double nm = 0, forward = 0, backward = 0;
  };

  std::vector<CheckFinding> findings;
  std::vector<Energy> energies;
  std::vector<Histogram> histograms;
  std::vector<Pair> pairs;
  double level = 0;  ///< smallest accepted p-value of a single test
  std::size_t statistical_tests = 0;
  double smallest_p = 1, largest_energy = 0, smallest_energy = 1, largest_mass_error = 0;
  double largest_failure = 0;  ///< largest fraction of samples without a direction
  bool black_below = false;    ///< whether nothing is scattered from below, as measured

  bool passed() const;
  /// Returns sentences about the failed tests; empty if all tests passed.
  std::vector<std::string> problems() const;
};

}  // namespace aureole
