// SPDX-License-Identifier: Apache-2.0
// g(r) of a fluid of equal hard discs, the transform of `hard_disc_structure_factor`.
#pragma once

namespace aureole::optics {

/// r in radii of the discs. Inside of contact, r < 2, the model is 0 only nearly, and a little negative,
/// since in two dimensions the direct correlation function of Rosenfeld (1990) is an approximation. Error of
/// the numerics below 1e-5 up to an area fraction of .6, 1e-4 at .7. Throws std::domain_error, with the
/// value, unless 0 <= r <= 200 and 0 <= area_fraction <= kMaxAreaFraction.
double hard_disc_pair_correlation(double r, double area_fraction);

}  // namespace aureole::optics
