// SPDX-License-Identifier: Apache-2.0
// The rules that every scattering function has to follow. Each lies in a file of its own, `<rule>_rule.cpp`;
// scattering_check.cpp calls them in order.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "aureole/instrument/check/check_run.h"
#include "aureole/instrument/check/direction_pairs.h"
#include "aureole/instrument/check/experiment.h"

namespace aureole::check {

/// The first fault of some samples.
struct SampleFault {
  std::string message;  ///< empty: there is none
  CheckRule rule = CheckRule::sample;
};
/// Rule `sample`: samples for wi are valid, and have the value and density that `eval_pdf` gives. `worst`
/// grows to the largest relative deviation from it.
SampleFault judge_samples(CheckRun& run, const Vec3& wi, std::span<const MaybeSample> samples,
                          CheckQuery query, double& worst);

/// Rule `finite`: grazing directions and the ends of the random numbers give valid numbers, and no sample
/// lacks a direction.
void check_finite(CheckRun& run);
/// The sentence about an invalid value or density.
std::string invalid_eval(const BsdfEval& eval, const Vec3& wi, const Vec3& wo);

/// Rule `black`: whether nothing at all was found in an experiment.
bool is_black(const DirectionBins& bins);
/// Adds the finding that nothing comes from wi, and where it passed an energy of zero.
void note_black(CheckRun& run, const Experiment& e, bool passed);

/// Rule `delta_lobes`: lobes occur as often as their mass says (binomial test).
void check_delta_masses(CheckRun& run, const Experiment& e);

/// Rule `density_integral`: densities, masses and failures add up to one.
void check_density_integral(CheckRun& run, const Experiment& e);

/// Rule `chi_square`: samples follow the density. Keeps the histogram.
void check_chi_square(CheckRun& run, const Experiment& e);

/// Rule `energy`: no energy is gained, and none lost where the options say so. Returns the energy of each
/// wavelength, in the order that has `hero` first, with each as hero for its delta lobes.
std::array<double, kWavelengths> check_energy(CheckRun& run, const Vec3& wi, int hero,
                                              const DirectionBins& bins);

/// Rule `sample_energy`: samples carry the energy that `eval` has for the hero.
void check_sample_energy(CheckRun& run, const Experiment& e, double energy);

/// Rule `wavelengths`: values and densities belong to wavelengths, not to their place among the N: rotating
/// which of them is the hero rotates them.
void check_wavelengths(CheckRun& run, const Vec3& wi);

/// Rule `modes` for delta lobes: radiance over n^2 is the quantity that they carry, in either direction.
void check_modes_of_deltas(CheckRun& run, const Vec3& wi);
/// Rule `modes`: importance mode is radiance mode with the roles of wi and wo exchanged.
void check_modes(CheckRun& run, const DirectionPairs& pairs);

/// Rule `reciprocity`: f / n_o^2 is the same both ways. Keeps the pairs of one wavelength.
void check_reciprocity(CheckRun& run, const DirectionPairs& pairs);

}  // namespace aureole::check
