// SPDX-License-Identifier: Apache-2.0
// Phase functions by their moments, the means of Legendre polynomials, which discrete ordinates require.
#pragma once

#include <memory>
#include <span>
#include <variant>
#include <vector>

#include "aureole/optics/particle/henyey_greenstein.h"
#include "aureole/optics/particle/phase_table.h"

namespace aureole::optics {

/// Phase function p(mu) = sum of (2 l + 1)/(4 pi) chi_l P_l(mu), in 1/sr, with mu the cosine of the
/// scattering angle; chi_0 = 1, chi_1 = g.
class LegendrePhase {
public:
  static LegendrePhase isotropic();
  /// The Henyey-Greenstein phase function, g in (-1, 1).
  static LegendrePhase henyey_greenstein(double g);
  static LegendrePhase double_henyey_greenstein(const DoubleHenyeyGreenstein& mixture);
  /// A phase function with the moments chi_0, chi_1, ...; further ones are 0. chi_0 must be 1, the others in
  /// [-1, 1]. The truncated series of a forward peak is negative for some mu, which is allowed.
  static LegendrePhase of_moments(std::vector<double> chi);
  /// A tabulated phase function, for instance by Mie theory. Its integral need not be 1.
  static LegendrePhase table(PhaseTable table);

  /// Returns chi_0 to chi_(count - 1). For tables Gauss quadrature in each step is exact to rounding errors.
  std::vector<double> moments(int count) const;
  double eval(double mu) const;  ///< Returns the phase function [1/sr].
  double asymmetry() const { return moments(2)[1]; }

private:
  using Kind = std::variant<DoubleHenyeyGreenstein, std::vector<double>, std::shared_ptr<const PhaseTable>>;
  explicit LegendrePhase(Kind kind) : kind_(std::move(kind)) {}
  Kind kind_;
};

/// Returns the sum of the series of `LegendrePhase` with these moments, in 1/sr.
double legendre_series(std::span<const double> chi, double mu);

}  // namespace aureole::optics
