// SPDX-License-Identifier: Apache-2.0
// Hard discs of several sizes in equilibrium, in closed form: fundamental measure theory in two dimensions
// (Rosenfeld, "Free-energy model for the inhomogeneous hard-sphere fluid in D dimensions", 1990).
// `hard_disc_structure_factor` is the case of one size.
#pragma once

#include <vector>

namespace aureole::optics {

class HardDiscMixture {
public:
  /// Classes of discs with number `fractions`, which are normalised. Throws std::domain_error for invalid
  /// arguments.
  HardDiscMixture(std::vector<double> radii, std::vector<double> fractions, double area_fraction);

  int classes() const { return int(radii_.size()); }
  double radius(int m) const { return radii_[m]; }
  double fraction(int m) const { return fractions_[m]; }
  double area_fraction() const { return area_fraction_; }
  double largest_radius() const;
  double mean_radius() const;
  double density() const { return density_; }  ///< discs per area

  /// Returns sqrt(rho_m rho_l) c_ml(q), with the direct correlation function c. The matrix C of these values
  /// gives the structure factors S = (1 - C)^-1.
  double direct(int m, int l, double q) const;

private:
  std::vector<double> radii_, fractions_;
  double area_fraction_, density_, chi_[3];
};

}  // namespace aureole::optics
