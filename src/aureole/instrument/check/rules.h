// SPDX-License-Identifier: Apache-2.0
// The rules for all scattering functions. Each is implemented in its own file, `<rule>_rule.cpp`;
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

/// The first fault found in some samples.
struct SampleFault {
  std::string message;  ///< description of the fault; empty: there is none
  CheckRule rule = CheckRule::sample;
};
/// Rule `sample`: samples for wi are valid and have the value and pdf of `eval_pdf`. `worst` is raised to the
/// largest relative deviation.
SampleFault judge_samples(CheckRun& run, const Vec3& wi, std::span<const MaybeSample> samples,
                          CheckQuery query, double& worst);

/// Rule `finite`: grazing directions and extreme random numbers give valid numbers, and every sample has a
/// direction.
void check_finite(CheckRun& run);
/// Message about an invalid value or pdf.
std::string invalid_eval(const BsdfEval& eval, const Vec3& wi, const Vec3& wo);

/// Rule `black`: whether all values and pdfs of an experiment are zero.
bool is_black(const DirectionBins& bins);
/// Adds the finding that nothing is scattered for wi and, if it passed, an energy of zero.
void note_black(CheckRun& run, const Experiment& e, bool passed);

/// Rule `delta_lobes`: frequencies of lobes agree with their probability masses (binomial test).
void check_delta_masses(CheckRun& run, const Experiment& e);

/// Rule `density_integral`: pdfs, masses and failures sum to one.
void check_density_integral(CheckRun& run, const Experiment& e);

/// Rule `chi_square`: samples follow the pdf. Stores the histogram.
void check_chi_square(CheckRun& run, const Experiment& e);

/// Rule `energy`: no energy is gained, and none is lost if the options exclude it. Returns the energy at each
/// wavelength, starting with wavelength `hero`; delta lobes are evaluated with each wavelength as the hero.
std::array<double, kWavelengths> check_energy(CheckRun& run, const Vec3& wi, int hero,
                                              const DirectionBins& bins);

/// Rule `sample_energy`: the mean sample weight equals the energy of `eval` at the hero wavelength.
void check_sample_energy(CheckRun& run, const Experiment& e, double energy);

/// Rule `wavelengths`: values and pdfs depend on wavelengths, not on their order. Choosing another hero
/// permutes them accordingly.
void check_wavelengths(CheckRun& run, const Vec3& wi);

/// Rule `modes` for delta lobes: they conserve radiance over n^2 in both modes.
void check_modes_of_deltas(CheckRun& run, const Vec3& wi);
/// Rule `modes`: importance mode equals radiance mode with wi and wo exchanged.
void check_modes(CheckRun& run, const DirectionPairs& pairs);

/// Rule `reciprocity`: f / n_o^2 is symmetric in wi and wo. Stores the pairs of one wavelength.
void check_reciprocity(CheckRun& run, const DirectionPairs& pairs);

}  // namespace aureole::check
