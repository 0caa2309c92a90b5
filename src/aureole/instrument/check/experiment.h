// SPDX-License-Identifier: Apache-2.0
// Many samples for one direction and one hero wavelength, sorted into bins adapted to the pdf: the data for
// the statistical rules.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "aureole/instrument/check/check_run.h"
#include "aureole/instrument/check/direction_bins.h"

namespace aureole::check {

struct Experiment {
  Vec3 wi;
  int hero;
  double nm;
  std::string where;  ///< the direction and the hero wavelength, for messages
  DirectionBins bins;
  std::vector<std::size_t> counts;  ///< samples in each bin
  std::vector<DeltaLobe> deltas;    ///< delta lobes with their sample counts, which may be zero
  std::size_t smooth = 0, none = 0;
  double weight = 0, weight2 = 0;  ///< sums of value/pdf at the hero wavelength, and of its square
};

/// Bins adapted to the pdf for wi, refined at pilot samples; the second function of the bins is the value.
/// Adds findings of the rules `sample` and `finite`; returns nothing if samples are invalid.
std::optional<DirectionBins> make_bins(CheckRun& run, const Vec3& wi, int hero, SeededRandom& random);

/// Samples one direction and hero wavelength. Returns nothing if samples are invalid, after adding a finding.
std::optional<Experiment> make_experiment(CheckRun& run, const Vec3& wi, int hero);

}  // namespace aureole::check
