// SPDX-License-Identifier: Apache-2.0
// The structure factor of equal hard discs in equilibrium, from a table of simulations: as accurate as
// `SimulatedStructureFactor`, and as fast as the theory of `hard_disc_structure_factor`.
#pragma once

#include "aureole/optics/arrangement/structure_factor.h"

namespace aureole::optics {

/// Largest area fraction of the table, which is the largest one of `HardDiscSimulation`.
inline constexpr double kMaxEquilibriumFraction = 0.68;

/// Returns 1/S' of the simulated discs minus 1/S' of the Percus-Yevick theory (`hard_disc_structure_factor`),
/// with the static structure factor S' at u = q a and an area fraction in [0, kMaxEquilibriumFraction]; 0 for
/// u of 40 or more. By the relation of Ornstein and Zernike, S' = 1/(1 - rho0 c), this is the error of the
/// theory's direct correlation function c, which is smooth in both arguments. The table holds 14 area
/// fractions, each from 9600 configurations of 2000 discs (tools/make_hard_disc_table.cpp). Throws
/// std::domain_error for other area fractions.
double equilibrium_correction(double u, double area_fraction);

/// Returns S' of equal hard discs in equilibrium. It agrees with independent
/// simulations within their standard errors (test `EquilibriumStructureFactor`).
inline double equilibrium_structure_factor(const HardDiscWave& wave, double u, double area_fraction) {
  return 1 / (1 / wave.structure_factor(area_fraction) + equilibrium_correction(u, area_fraction));
}

}  // namespace aureole::optics
