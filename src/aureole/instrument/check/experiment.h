// SPDX-License-Identifier: Apache-2.0
// Many samples for one direction and one hero, sorted into bins that follow the density: the data that the
// statistical rules judge.
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
  std::string where;  ///< the direction and the hero, for messages
  DirectionBins bins;
  std::vector<std::size_t> counts;  ///< samples in each bin
  std::vector<DeltaLobe> deltas;    ///< with their samples; lobes that were not met have none
  std::size_t smooth = 0, none = 0;
  double weight = 0, weight2 = 0;  ///< sums of value/density at the hero, and of its square
};

/// Bins that follow the density for wi, refined where pilot samples fall; the bins' further integrals are
/// those of the values. Leaves findings of the rules `sample` and `finite`; nothing where samples are wrong.
std::optional<DirectionBins> make_bins(CheckRun& run, const Vec3& wi, int hero, SeededRandom& random);

/// Nothing where samples are wrong, after a finding that says so.
std::optional<Experiment> make_experiment(CheckRun& run, const Vec3& wi, int hero);

}  // namespace aureole::check
