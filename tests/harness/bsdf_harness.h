// SPDX-License-Identifier: Apache-2.0
// The cases over which `check_bsdf` runs: all registered BSDFs (tests/bsdf/bsdf_harness_test.cpp). A plug-in's own
// test file adds parameter sets by `BsdfCases`.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "aureole/instrument/check/bsdf_check.h"

namespace aureole::testing {

/// One BSDF and the expectations that it is tested against.
struct BsdfCase : CheckOptions {
  BsdfCase() { min_nm = 360, max_nm = 830; }

  std::string name;  ///< letters, digits and underscores
  std::string xml;
  std::shared_ptr<const Bsdf> bsdf;  ///< instead of xml, for a class that is not registered
  std::string not_reciprocal;        ///< the reason, where reciprocity is not to be tested
  /// The reason, where a model reflects more light than it receives; `largest_energy` says how much.
  std::string gains_energy;
};

struct HarnessOptions {
  double family_significance = 0.01;
  std::size_t family_size = 1;  ///< number of cases in the family
  std::filesystem::path dump_folder = ".";
  std::uint64_t seed = 1;
  std::size_t most_samples = 75000;  ///< without AUREOLE_THOROUGH
};

/// The faults of one case, in sentences (empty where there are none), and the numbers behind them.
struct HarnessResult {
  std::vector<std::string> failures;
  CheckResult check;
};
HarnessResult check_case(const BsdfCase& c, const HarnessOptions& options);

/// Registers further cases for a plug-in, and adapts those made from its documentation's examples (which
/// expect nothing special). Meant for a static object in the plug-in's own test file.
class BsdfCases {
public:
  BsdfCases(std::string plugin, std::function<void(BsdfCase&)> adapt, std::vector<BsdfCase> extra);
};

/// The cases with that many samples for each direction and wavelength: of parameter sets whose samples come from
/// code that another case of the plug-in, or the nested BSDF's own, tests with all of them.
std::vector<BsdfCase> with_samples(std::size_t samples, std::vector<BsdfCase> cases);

/// All cases: the examples of every registered BSDF, and those that were added.
std::vector<BsdfCase> all_bsdf_cases();

}  // namespace aureole::testing
