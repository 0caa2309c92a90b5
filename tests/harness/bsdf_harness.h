// SPDX-License-Identifier: Apache-2.0
// What every BSDF has to fulfil, checked by numbers. See tests/bsdf/harness_test.cpp, which runs it over all
// registered BSDFs; a plug-in's own test file adds parameter sets by `BsdfCases`.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "aureole/bsdf/bsdf.h"

namespace aureole::testing {

/// One BSDF and what is to be expected of it.
struct BsdfCase {
  std::string name;  ///< letters, digits and underscores
  std::string xml;
  std::shared_ptr<const Bsdf> bsdf;  ///< instead of xml, for what is not registered
  /// Nothing is absorbed and nothing fails, for wi above the surface (and below, if it transmits or is
  /// two-sided).
  bool lossless = false;
  bool black_below = false;    ///< wi.z < 0 gives no sample and no value
  bool may_fail = false;       ///< `sample` may return nothing; the densities then integrate to less than one
  std::string not_reciprocal;  ///< the reason, where reciprocity is not to be tested
  /// The reason, where a model reflects more light than it receives, and how much it may reflect then.
  std::string gains_energy;
  double largest_energy = 1;
  /// In which mode samples and energies are tested; in the other one a BSDF that is not reciprocal may gain
  /// energy.
  TransportMode mode = TransportMode::importance;
  std::function<float(float nm)> n_above, n_below;  ///< indices on the two sides; 1 where not given
  /// Directions around which lobes are narrow, for a given wi, and how wide bins may be there [rad].
  std::function<std::vector<Vec3>(const Vec3& wi)> focus;
  double focus_angle = 0.02;
  double min_nm = 360, max_nm = 830;  ///< range of the sensor
  std::size_t samples = 300000;
  double tolerance = 2e-3;  ///< of energies and masses by quadrature
};

struct HarnessOptions {
  double family_significance = 0.01;
  std::size_t family_size = 1;  ///< number of cases in the family; the tests in a case are counted in
  std::filesystem::path dump_folder = ".";
  std::uint64_t seed = 1;
};

/// What one case was found to do wrong, in sentences; empty where all is well.
std::vector<std::string> check_bsdf(const BsdfCase& c, const HarnessOptions& options);

/// The numbers behind the last check, for reports: smallest p-value, largest and smallest energy, largest
/// error of a mass.
struct HarnessFigures {
  double smallest_p = 1, largest_energy = 0, smallest_energy = 1, largest_mass_error = 0;
  std::size_t statistical_tests = 0;
};
const HarnessFigures& last_figures();

/// Registers further cases for a plug-in, and adapts those made from its documentation's examples (which
/// expect nothing special). Meant for a static object in the plug-in's own test file.
class BsdfCases {
public:
  BsdfCases(std::string plugin, std::function<void(BsdfCase&)> adapt, std::vector<BsdfCase> extra);
};

/// All cases: the examples of every registered BSDF, and what was added.
std::vector<BsdfCase> all_bsdf_cases();

}  // namespace aureole::testing
