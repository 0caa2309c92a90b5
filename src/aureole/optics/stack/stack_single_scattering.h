// SPDX-License-Identifier: Apache-2.0
// Single scattering of a beam in closed form, by the whole phase function and by its truncated series: the
// correction of radiances after delta-M scaling (Nakajima & Tanaka 1988, method TMS). Internal to the
// library.
#pragma once

#include <span>
#include <vector>

#include "aureole/optics/stack/stack_solver.h"

namespace aureole::optics {

class SingleScattering {
public:
  SingleScattering(const StackSolver& solver, const StackDescription& description)
      : solver_(solver), description_(description) {}

  /// Whether delta-M scaling has changed any layer, so that a correction is needed.
  bool corrects() const;

  /// A beam of irradiance 1 on the stack, and its unscattered light at all levels.
  struct Beam {
    int channel;
    Vector paths;  ///< unscattered light, in the order of StackSolver::unscattered
  };
  Beam light(int channel, bool from_below) const;

  /// Returns the missing radiance in a channel for each azimuth, due to the difference of the two phase
  /// functions.
  std::vector<double> correction(const Beam& beam, int channel, int level, bool goes_up,
                                 std::span<const double> azimuths) const;

private:
  const StackSolver& solver_;
  const StackDescription& description_;
};

}  // namespace aureole::optics
