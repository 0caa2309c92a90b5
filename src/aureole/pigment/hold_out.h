// SPDX-License-Identifier: Apache-2.0
// Cross-validation of fits: specimens are kept back, the rest is fitted, and the specimens are predicted.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "aureole/core/parallel_for.h"
#include "aureole/pigment/joint_fit.h"
#include "aureole/pigment/observation.h"

namespace aureole::pigment {

/// A specimen that was kept back, and its prediction.
struct HeldOut {
  std::string specimen;              ///< name of the specimen
  std::vector<std::size_t> samples;  ///< indices of its samples in the table
  std::vector<JointPrediction>
      predictions;          ///< one prediction for each sample; empty if the rest lacks one of the paints
  std::string reason = {};  ///< reason why there is no prediction
};

/// Groups of specimen names that are kept back together.
using HoldOutGroups = std::vector<std::vector<std::string>>;

/// Returns groups of one mixture each.
HoldOutGroups each_mixture(const SampleTable& table);
/// Returns all specimens in `count` groups of nearly equal size: specimen i belongs to group i mod `count`.
HoldOutGroups in_groups(const SampleTable& table, int count);

/// The groups that words name: names of specimens that are kept back together; or one word that is not such a name,
/// "each" (every mixture by itself) or a number of groups.
HoldOutGroups hold_out_groups(const SampleTable& table, std::vector<std::string> words);

/// Fits without each group in turn, starting from `full`, the fit of all specimens. Throws std::domain_error if a
/// name is not that of a specimen, with the known ones.
std::vector<HeldOut> hold_out(const SampleTable& table, const FilmTheory& theory,
                              const JointSettings& settings, const HoldOutGroups& groups,
                              const JointFit& full, bool with_errors,
                              const ParallelFor& threads = serial_for);

/// The baseline: the two-constant theory with nothing else unknown (`JointSettings::plain`, but with the default errors of
/// reflectance of `JointSettings`), fitted anew for each group to the series of its specimens and to all specimens of
/// `white`, `black` and their mixtures. Where these lack a paint, the fit includes the series of that paint.
std::vector<HeldOut> hold_out_plain(const SampleTable& table, const FilmTheory& theory,
                                    const HoldOutGroups& groups, const std::string& white,
                                    const std::string& black, const ParallelFor& threads = serial_for);

/// CIEDE2000 of predicted and measured colours of each specimen that was predicted, by name: the mean over its measured
/// reflectances.
std::map<std::string, double> held_out_differences(const SampleTable& table, const std::vector<HeldOut>& held,
                                                   const Observation& lamp);

/// Fraction of the measured values that lie within the 90 % intervals of their predictions, of predictions with errors.
double interval_coverage(const SampleTable& table, const std::vector<HeldOut>& held);

/// Whether the other specimens tell how each paint of a mixture scatters: each paint, except `white` and `black`,
/// is in another mixture with a paint that is not `black`.
bool is_determined(const SampleTable& table, const std::string& specimen, const std::string& white,
                   const std::string& black);

}  // namespace aureole::pigment
