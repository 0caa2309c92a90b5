// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/check/scattering_check.h"

#include <algorithm>

#include "aureole/instrument/check/rules.h"

namespace aureole {

namespace {

using namespace check;

/// Applies the rules that need many samples, for one direction and hero wavelength.
void check_samples(CheckRun& run, const Vec3& wi, int hero, bool below) {
  const CheckOptions& options = run.options();
  const std::optional<Experiment> made = make_experiment(run, wi, hero);
  if (!made) return;
  const Experiment& e = *made;
  const bool nothing_drawn = e.none == options.samples;
  if (below && options.black_below) return note_black(run, e, nothing_drawn && !(e.bins.mass() > 0));
  if (nothing_drawn && is_black(e.bins)) {
    if (below && options.may_be_black_below) return note_black(run, e, true);
    if (options.may_fail) return;
  }
  double& failure = run.result().largest_failure;
  failure = std::max(failure, double(e.none) / double(options.samples));
  check_delta_masses(run, e);
  check_density_integral(run, e);
  check_chi_square(run, e);
  check_sample_energy(run, e, check_energy(run, wi, hero, e.bins)[0]);
}

/// Checks only the energy, for the further angles of `energy_angles`.
void check_energy_between(CheckRun& run, const Vec3& wi, bool below) {
  const CheckOptions& options = run.options();
  if (below && (options.black_below || run.result().black_below)) return;
  SeededRandom random(options.seed * 1000003 + std::uint64_t(1000 * (wi.z + 2)));
  if (const std::optional<DirectionBins> bins = make_bins(run, wi, 0, random))
    check_energy(run, wi, 0, *bins);
}

}  // namespace

CheckResult check_scattering(const ScatteringFunction& function, const CheckOptions& options) {
  CheckRun run(function, options);
  for (const float degrees : kAngles)
    for (const bool below : {false, true}) {
      const Vec3 wi = direction_at(degrees, below);
      const std::size_t before = run.failures();
      for (const int hero : {0, kWavelengths - 3}) check_samples(run, wi, hero, below);
      if (run.failures() == before) check_wavelengths(run, wi);
      check_modes_of_deltas(run, wi);
    }
  for (const double degrees : options.energy_angles)
    for (const bool below : {false, true}) check_energy_between(run, direction_at(degrees, below), below);
  if (has(function.lobes(), Lobe::diffuse | Lobe::glossy)) {
    const DirectionPairs pairs = make_direction_pairs(run);
    check_modes(run, pairs);
    check_reciprocity(run, pairs);
  }
  check_finite(run);
  return run.finish();
}

}  // namespace aureole
