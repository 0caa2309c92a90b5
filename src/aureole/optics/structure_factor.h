// SPDX-License-Identifier: Apache-2.0
// How much the waves of scatterers on correlated positions interfere, relative to random positions.
#pragma once

#include <cmath>

namespace aureole::optics {

/// S'(u) of one arrangement of scatterers, without the delta at 0, in terms of u = q a, a the correlation
/// radius.
class StructureFactor {
public:
  virtual ~StructureFactor() = default;
  /// For |u|; of an anisotropic arrangement the mean over the ring. Never negative.
  virtual double eval(double u) const = 0;
  /// For a vector u = (ux, uy).
  virtual double eval(double ux, double uy) const { return eval(std::hypot(ux, uy)); }
  virtual bool is_isotropic() const { return true; }
};

/// Largest area fraction that the structure factor accepts: the equilibrium fluid of hard discs ends near it.
inline constexpr double kMaxAreaFraction = 0.7;

/// Structure factor without its delta, S'(u; Fa) = 1 + rho0 * integral of (g(r) - 1) exp(-i q.r) d2r, of a
/// fluid of equal hard discs of radius a, at u = |q| a (dimensionless, rad) and area fraction Fa = rho0 pi
/// a^2. Percus-Yevick form of Rosenfeld ("Free-energy model for the inhomogeneous hard-sphere fluid in D
/// dimensions", 1990, equations 4.4-4.6), written as in Yang, Kim, Pediredla & Jarosz ("A wave-optics BSDF
/// for correlated scatterers", 2025, equations 15 and 16). Always positive; S'(0) = (1-Fa)^3/(1+Fa); 1 for
/// large u. Throws std::domain_error, with the value, unless 0 <= area_fraction <= kMaxAreaFraction.
double hard_disc_structure_factor(double u, double area_fraction);

}  // namespace aureole::optics
