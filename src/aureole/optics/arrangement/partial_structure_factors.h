// SPDX-License-Identifier: Apache-2.0
// Partial structure factors of hard discs of several sizes, from theory alone or corrected by a simulation.
#pragma once

#include <vector>

#include "aureole/optics/arrangement/hard_disc_mixture.h"
#include "aureole/optics/arrangement/pair_statistics.h"

namespace aureole::optics {

/// S_ml(q) in the normalisation of Ashcroft & Langreth (1967): 1 for m = l and 0 else where positions are
/// random or q is large. The layer's intensity is J(q) = rho sum_ml sqrt(P_m P_l) F_m conj(F_l) S_ml(q),
/// never negative, since the matrix S is positive definite at every q.
///
/// S = (1 - C)^-1, and the direct correlation C is smooth and of short range where S is not (Ornstein &
/// Zernike). Simulated S are therefore fitted, ring by ring, by a correction of the theoretical C: piecewise
/// linear functions of r inside of contact and out to six mean diameters beyond it, with a jump at contact.
class PartialStructureFactors {
public:
  /// Theory: Rosenfeld (1990). `q_max`: end of the table.
  PartialStructureFactors(const HardDiscMixture& mixture, double q_max);
  /// Corrected by `measured`, whose classes are those of the mixture.
  PartialStructureFactors(const HardDiscMixture& mixture, double q_max, const RingStructureFactor& measured);

  int classes() const { return mixture_.classes(); }
  double radius(int m) const { return mixture_.radius(m); }
  double fraction(int m) const { return mixture_.fraction(m); }
  const HardDiscMixture& mixture() const { return mixture_; }

  /// q in rad per unit of the radii.
  double eval(int m, int l, double q) const;
  /// Standard error of `eval` due to the finite simulation; 0 for theory. For several classes it is several
  /// times too large, since it takes the errors of the elements of C for independent.
  double error(int m, int l, double q) const;
  /// Mean square of (measured - fit)/error over all rings: near 1 if the correction describes the data.
  double chi_squared() const { return chi_squared_; }

private:
  int pair(int m, int l) const;
  void fit(const RingStructureFactor& measured);
  void tabulate();
  std::vector<double> theory_matrix(double q) const;
  double look_up(const std::vector<float>& table, int pair, double q) const;

  struct Correction {                  // of one pair of classes
    std::vector<double> knots;         // r; the contact distance occurs twice
    std::vector<double> coefficients;  // c(r) - theory at the knots; 0 at the last
    std::vector<double> covariance;
    double scale = 0;  // sqrt(rho_m rho_l)
    /// Transforms of the hat functions of the knots.
    std::vector<double> basis(double q) const;
  };

  HardDiscMixture mixture_;
  double q_max_, step_;
  double chi_squared_ = 0;
  std::vector<Correction> corrections_;
  std::vector<float> values_, errors_;  // [pair][node]
};

}  // namespace aureole::optics
