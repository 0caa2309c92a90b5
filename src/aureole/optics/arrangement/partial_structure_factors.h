// SPDX-License-Identifier: Apache-2.0
// Partial structure factors of hard discs of several sizes, from theory alone or with a correction from
// simulations.
#pragma once

#include <vector>

#include "aureole/optics/arrangement/hard_disc_mixture.h"
#include "aureole/optics/arrangement/pair_statistics.h"

namespace aureole::optics {

/// Partial structure factors S_ml(q), normalised as by Ashcroft & Langreth (1967): for random positions or
/// large q they are 1 if m = l, else 0. The intensity of a layer is J(q) = rho sum_ml sqrt(P_m P_l) F_m
/// conj(F_l) S_ml(q). It is never negative, since the matrix S is positive definite at every q.
/// By the Ornstein-Zernike relation S = (1 - C)^-1. The direct correlation C is smooth and short-ranged,
/// unlike S. Simulated S are therefore fitted, ring by ring, by a correction of the theoretical C. The
/// correction is piecewise linear in r, inside contact and up to six mean diameters beyond it, with a jump at
/// contact.
class PartialStructureFactors {
public:
  /// Tabulates the theory (Rosenfeld 1990) for q up to `q_max`.
  PartialStructureFactors(const HardDiscMixture& mixture, double q_max);
  /// Tabulates the theory corrected by `measured`, which must have the classes of the mixture.
  PartialStructureFactors(const HardDiscMixture& mixture, double q_max, const RingStructureFactor& measured);

  int classes() const { return mixture_.classes(); }
  double radius(int m) const { return mixture_.radius(m); }
  double fraction(int m) const { return mixture_.fraction(m); }
  const HardDiscMixture& mixture() const { return mixture_; }

  /// Returns S_ml(q), q in rad per unit of the radii.
  double eval(int m, int l, double q) const;
  /// Returns the standard error of `eval` due to the finite simulation; 0 for theory. For several classes it
  /// is several times too large, since the elements of C are treated as independent.
  double error(int m, int l, double q) const;
  /// Returns the mean square of (measured - fit)/error over all rings; near 1 if the correction describes the
  /// data.
  double chi_squared() const { return chi_squared_; }

private:
  int pair(int m, int l) const;
  void fit(const RingStructureFactor& measured);
  void tabulate();
  std::vector<double> theory_matrix(double q) const;
  double look_up(const std::vector<float>& table, int pair, double q) const;

  struct Correction {                  // correction of C for one pair of classes
    std::vector<double> knots;         // knots in r; the contact distance occurs twice
    std::vector<double> coefficients;  // c(r) minus the theory at the knots; 0 at the last knot
    std::vector<double> covariance;
    double scale = 0;  // normalisation sqrt(rho_m rho_l)
    /// Returns the Fourier transforms of the hat functions at the knots.
    std::vector<double> basis(double q) const;
  };

  HardDiscMixture mixture_;
  double q_max_, step_;
  double chi_squared_ = 0;
  std::vector<Correction> corrections_;
  std::vector<float> values_, errors_;  // values of S_ml and their errors, by [pair][node]
};

}  // namespace aureole::optics
