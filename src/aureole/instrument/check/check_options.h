// SPDX-License-Identifier: Apache-2.0
// The expectations that a check of a scattering function (BSDF or phase function) tests it against.
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
  /// Nothing is absorbed and nothing fails, for wi above the surface (and below, if it transmits or is
  /// two-sided).
  bool lossless = false;
  bool black_below = false;         ///< wi.z < 0 gives no sample and no value
  bool may_be_black_below = false;  ///< where wi.z < 0 gives neither, that is all right
  bool may_fail = false;      ///< `sample` may return nothing; the densities then integrate to less than one
  bool reciprocal = true;     ///< f / n_o^2 is the same both ways
  double largest_energy = 1;  ///< more than 1 where a model is known to reflect more light than it receives
  /// The mode in which samples and energies are tested. In the other one a function that is not reciprocal
  /// may gain energy.
  TransportMode mode = TransportMode::importance;
  std::function<float(float nm)> n_above, n_below;  ///< refractive indices on the two sides; 1 if not given
  bool indices_from_samples = false;                ///< their ratio is read from samples (`eta`)
  /// Directions around which lobes are narrow, for a given wi, and how wide bins may be there [rad].
  std::function<std::vector<Vec3>(const Vec3& wi)> focus;
  double focus_angle = 0.02;
  double min_nm = 0, max_nm = 0;  ///< wavelengths; both zero: all that the function is tabulated for
  std::size_t samples = 300000;   ///< for each of 6 directions and 2 wavelengths
  double tolerance = 2e-3;        ///< of energies and masses by quadrature
  double bin_tolerance = 1e-6;  ///< of the integrals over one bin, which is divided until they change by less
  /// For fewer than the usual 300,000 samples, whose noise in each bin is larger: as that noise.
  static double bin_tolerance_for(std::size_t samples) {
    return 1e-6 * std::sqrt(3e5 / double(std::min<std::size_t>(samples, 300000)));
  }
  std::size_t most_bins = 1000000;  ///< where quadrature gives up
  /// Probability that a correct function of the family fails one of its statistical tests.
  double significance = 0.01;
  std::size_t family_size = 1;  ///< functions that are checked together; the tests of one are counted in
  std::uint64_t seed = 1;
  /// Further angles [degrees] at which energies are computed and bounded, beside those of the samples.
  std::vector<double> energy_angles;
  /// Called often with the part that is done, in [0, 1]; may throw to end the check.
  std::function<void(double)> progress;
};

}  // namespace aureole
