// SPDX-License-Identifier: Apache-2.0
// The expected properties against which a scattering function (BSDF or phase function) is checked.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "aureole/bsdf/bsdf.h"

namespace aureole {

struct CheckOptions {
  /// Energy is conserved and sampling never fails, for wi above the surface (and below, if it transmits or is
  /// two-sided).
  bool lossless = false;
  bool black_below = false;         ///< for wi.z < 0 there is no sample and no value
  bool may_be_black_below = false;  ///< for wi.z < 0, no sample and no value is also accepted
  bool may_fail = false;            ///< `sample` may return nothing; the pdfs then integrate to less than one
  bool reciprocal = true;           ///< f / n_o^2 is symmetric in wi and wo
  double largest_energy = 1;        ///< more than 1 for a model known to reflect more light than it receives
  /// The mode in which samples and energies are tested. In the other mode a non-reciprocal function may gain
  /// energy.
  TransportMode mode = TransportMode::importance;
  std::function<float(float nm)> n_above, n_below;  ///< indices of refraction on both sides; 1 if null
  bool indices_from_samples = false;                ///< their ratio is taken from samples (`eta`)
  /// Directions around which lobes are narrow, for a given wi, and the largest bin size there [rad].
  std::function<std::vector<Vec3>(const Vec3& wi)> focus;
  double focus_angle = 0.02;
  double min_nm = 0, max_nm = 0;  ///< wavelength range; both zero: the whole tabulated range
  std::size_t samples = 300000;   ///< number of samples for each of 6 directions and 2 hero wavelengths
  double tolerance = 2e-3;        ///< tolerance of energies and masses computed by quadrature
  /// tolerance of the integrals over one bin, which is divided until they change by less
  double bin_tolerance = 1e-6;
  /// The `bin_tolerance` for fewer than the usual 300,000 samples, proportional to their statistical noise
  /// per bin.
  static double bin_tolerance_for(std::size_t samples) {
    return 1e-6 * std::sqrt(3e5 / double(std::min<std::size_t>(samples, 300000)));
  }
  std::size_t most_bins = 1000000;  ///< number of bins at which quadrature stops
  /// Probability that a correct function of the family fails any of the statistical tests.
  double significance = 0.01;
  std::size_t family_size = 1;  ///< number of functions checked together; `significance` applies to the tests
                                ///< of all of them
  std::uint64_t seed = 1;
  /// Further angles of incidence [degrees] at which energies are computed and bounded, besides the sampled
  /// ones.
  std::vector<double> energy_angles;
  /// Called often with the completed fraction in [0, 1]; may throw to cancel the check.
  std::function<void(double)> progress;
};

}  // namespace aureole
