// SPDX-License-Identifier: Apache-2.0
// Phase functions by their moments, means of Legendre's polynomials, which is how discrete ordinates know them.
#pragma once

#include <memory>
#include <span>
#include <variant>
#include <vector>

#include "aureole/optics/particle/henyey_greenstein.h"
#include "aureole/optics/particle/phase_table.h"

namespace aureole::optics {

/// p(mu) = sum of (2 l + 1)/(4 pi) chi_l P_l(mu), in 1/sr, mu the cosine of the scattering angle; chi_0 = 1, chi_1 = g.
class LegendrePhase {
public:
  static LegendrePhase isotropic();
  /// g in (-1, 1).
  static LegendrePhase henyey_greenstein(double g);
  static LegendrePhase double_henyey_greenstein(const DoubleHenyeyGreenstein& mixture);
  /// chi_0, chi_1, ...; those that are not given are 0. chi_0 must be 1, the others in [-1, 1]. Truncated series of
  /// forward peaks have negative values somewhere; nothing here minds.
  static LegendrePhase of_moments(std::vector<double> chi);
  /// Any table, for instance of Mie's theory. Its integral need not be 1.
  static LegendrePhase table(PhaseTable table);

  /// chi_0 to chi_(count - 1). Of tables by Gauss quadrature in each step, exact to rounding errors.
  std::vector<double> moments(int count) const;
  double eval(double mu) const;  ///< 1/sr
  double asymmetry() const { return moments(2)[1]; }

private:
  using Kind = std::variant<DoubleHenyeyGreenstein, std::vector<double>, std::shared_ptr<const PhaseTable>>;
  explicit LegendrePhase(Kind kind) : kind_(std::move(kind)) {}
  Kind kind_;
};

/// The sum that `LegendrePhase` is, of so many moments: 1/sr.
double legendre_series(std::span<const double> chi, double mu);

}  // namespace aureole::optics
