// SPDX-License-Identifier: Apache-2.0
// Phase functions as tables over mu, the cosine of the scattering angle, with nodes where the function needs
// them: a rainbow some tenths of a degree, the forward peak of large particles seconds of arc.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace aureole::optics {

/// p in 1/sr, linear in mu between the nodes: its integrals and samples are exact.
struct PhaseTable {
  std::vector<double> mu;  ///< increasing, from -1 to 1
  std::vector<double> p;   ///< >= 0

  /// mu is clamped to [-1, 1].
  double eval(double mu) const;
  /// Integral over the sphere; 1 of what `tabulate_phases` returns.
  double integral() const;
  /// Mean of Legendre's polynomial P_l(mu), l in [0, 3]; l = 1: the asymmetry g.
  double legendre(int l) const;
  double asymmetry() const { return legendre(1); }
  /// Probability of scattering below each mu, from 0 to 1.
  std::vector<double> cdf() const;
  /// The mu at which `cdf` (of this table) would be u in [0, 1].
  double sample(std::span<const double> cdf, double u) const;
};

struct PhaseAccuracy {
  /// Largest error of linear interpolation, relative to the local value or, where that is smaller, to `floor`
  /// of the mean over the sphere. Tested in the middle of each step, which is halved without another test where
  /// that is off by up to twice as much.
  double relative = 2e-3, floor = 1e-3;
  std::size_t most_nodes = 60000;
};

struct PhaseTables {
  std::vector<PhaseTable> tables;  ///< all with the same mu, each normalised
  std::vector<double> integrals;   ///< over the sphere, before that
  double error = 0;  ///< the largest that was left, relative as above: above `relative` where nodes ran out
};

/// Puts values of one or more functions at mu[i] into at[function][i], and at -mu[i] into mirrored[function][i].
using PhaseEvaluator = std::function<void(std::span<const double> mu, std::vector<std::vector<double>>& at,
                                          std::vector<std::vector<double>>& mirrored)>;

/// Tables of `count` functions, in any unit, on one grid that suits them all. The first grid has steps of
/// `peak` (rad) at both ends, growing to `step`: nothing narrower than those is found unless something beside
/// it is. Steps are halved until each function is linear in each. Throws std::domain_error where a value is
/// negative or not finite, or a function has no mass.
PhaseTables tabulate_phases(const PhaseEvaluator& evaluate, std::size_t count, double peak, double step,
                            const PhaseAccuracy& accuracy = {});

}  // namespace aureole::optics
