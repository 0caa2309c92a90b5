// SPDX-License-Identifier: Apache-2.0
// Phase functions as tables over mu, the cosine of the scattering angle, with adaptive nodes. A rainbow is
// some tenths of a degree wide, the forward peak of large particles only arcseconds.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace aureole::optics {

/// Phase function p in 1/sr, linear in mu between the nodes, so that integrals and samples are exact.
struct PhaseTable {
  std::vector<double> mu;  ///< cosines of the scattering angle, increasing from -1 to 1
  std::vector<double> p;   ///< phase function at the nodes [1/sr], not negative

  /// Returns p; mu is clamped to [-1, 1].
  double eval(double mu) const;
  /// Returns the integral over the sphere, which is 1 for tables from `tabulate_phases`.
  double integral() const;
  /// Returns the mean of the Legendre polynomial P_l(mu), l in [0, 3]; l = 1 is the asymmetry g.
  double legendre(int l) const;
  double asymmetry() const { return legendre(1); }
  /// Returns the cumulative distribution at each mu, from 0 to 1.
  std::vector<double> cdf() const;
  /// Returns the mu at which the cumulative distribution `cdf` of this table is u in [0, 1].
  double sample(std::span<const double> cdf, double u) const;
};

struct PhaseAccuracy {
  /// Largest error of linear interpolation, relative to the local value or, if that is smaller, to `floor`
  /// times the mean over the sphere. It is tested in the middle of each step. If the error there is at most
  /// twice the bound, the step is halved without a further test.
  double relative = 2e-3, floor = 1e-3;
  std::size_t most_nodes = 60000;
};

struct PhaseTables {
  std::vector<PhaseTable> tables;  ///< tables with equal mu, each normalised
  std::vector<double> integrals;   ///< integrals over the sphere before normalisation
  double error = 0;  ///< largest remaining relative error; above `relative` if the nodes were exhausted
};

/// Evaluates one or more functions: writes values at mu[i] to at[function][i], at -mu[i] to
/// mirrored[function][i].
using PhaseEvaluator = std::function<void(std::span<const double> mu, std::vector<std::vector<double>>& at,
                                          std::vector<std::vector<double>>& mirrored)>;

/// Tabulates `count` functions, in any unit, on a common grid. The first grid has steps of `peak` (rad) at
/// both ends, growing to `step`: narrower features are found only if the refinement reaches them. Steps are
/// halved until each function is linear in each of them. Throws std::domain_error if a value is negative or
/// not finite, or the integral of a function is 0.
PhaseTables tabulate_phases(const PhaseEvaluator& evaluate, std::size_t count, double peak, double step,
                            const PhaseAccuracy& accuracy = {});

}  // namespace aureole::optics
