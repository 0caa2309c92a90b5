// SPDX-License-Identifier: Apache-2.0
// The pdf of the time of a path: more times while the lights are bright, so that short pulses in a long exposure are found.
#pragma once

#include <span>
#include <vector>

#include "aureole/modulation/modulation.h"

namespace aureole {

/// A modulation and the power of the lights that it modulates, in a scale that all share.
struct ModulatedPower {
  const Modulation* modulation = nullptr;
  double power = 0;
};

/// A piecewise constant pdf over the times of an exposure: the power of all lights together, with an even part of 20 %, so
/// that nothing is missed that moves in the light of a steady lamp. Cells are halved where the power varies most within them.
class ExposureTimes {
public:
  /// `steady` is the power of the lights that are not modulated. Requires close > open.
  ExposureTimes(double open, double close, double steady, std::span<const ModulatedPower> modulated);

  struct Sample {
    double time;     ///< [s]
    double density;  ///< pdf of the time over that of even times between `from` and `to`
  };
  /// Samples a time between two times of the exposure, from < to.
  Sample sample(double u, double from, double to) const;
  /// Whether the pdf varies by so much that times are worth sampling by it.
  bool is_uneven() const { return is_uneven_; }

private:
  double cumulative(double time) const;

  std::vector<double> edges_, below_;  ///< of the cells, and the probability of all times before
  bool is_uneven_ = false;
};

}  // namespace aureole
