// SPDX-License-Identifier: Apache-2.0
// The cases over which `check_bsdf` runs: all registered BSDFs (tests/bsdf/harness_test.cpp). A plug-in's own
// test file adds parameter sets by `BsdfCases`.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "aureole/instrument/bsdf_check.h"

namespace aureole::testing {

/// One BSDF and what is to be expected of it.
struct BsdfCase : BsdfCheckOptions {
  BsdfCase() { min_nm = 360, max_nm = 830; }

  std::string name;  ///< letters, digits and underscores
  std::string xml;
  std::shared_ptr<const Bsdf> bsdf;  ///< instead of xml, for what is not registered
  std::string not_reciprocal;        ///< the reason, where reciprocity is not to be tested
  /// The reason, where a model reflects more light than it receives; `largest_energy` says how much.
  std::string gains_energy;
};

struct HarnessOptions {
  double family_significance = 0.01;
  std::size_t family_size = 1;  ///< number of cases in the family
  std::filesystem::path dump_folder = ".";
  std::uint64_t seed = 1;
};

/// What one case was found to do wrong, in sentences (empty where all is well), and the numbers behind it.
struct HarnessResult {
  std::vector<std::string> failures;
  BsdfCheckResult check;
};
HarnessResult check_case(const BsdfCase& c, const HarnessOptions& options);

/// Registers further cases for a plug-in, and adapts those made from its documentation's examples (which
/// expect nothing special). Meant for a static object in the plug-in's own test file.
class BsdfCases {
public:
  BsdfCases(std::string plugin, std::function<void(BsdfCase&)> adapt, std::vector<BsdfCase> extra);
};

/// All cases: the examples of every registered BSDF, and what was added.
std::vector<BsdfCase> all_bsdf_cases();

}  // namespace aureole::testing
