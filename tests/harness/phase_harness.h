// SPDX-License-Identifier: Apache-2.0
// The cases over which `check_phase` runs: all registered phase functions
// (tests/phase/phase_harness_test.cpp). A plug-in's own test file adds parameter sets by `PhaseCases`.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "aureole/instrument/check/phase_check.h"

namespace aureole::testing {

/// One phase function and the expectations that it is tested against.
struct PhaseCase : CheckOptions {
  PhaseCase(std::string name, std::string xml);

  std::string name;  ///< letters, digits and underscores
  std::string xml;
};

/// Registers further cases, and adapts those made from the examples of a plug-in's documentation. Meant for a
/// static object in the plug-in's own test file.
class PhaseCases {
public:
  PhaseCases(std::string plugin, std::function<void(PhaseCase&)> adapt, std::vector<PhaseCase> extra);
};

/// A peak straight on (and straight back) as narrow as `angle` [rad], for the bins of samples.
void has_peaks(PhaseCase& c, double angle);

/// All cases: the examples of every registered phase function, and those that were added.
std::vector<PhaseCase> all_phase_cases();

}  // namespace aureole::testing
