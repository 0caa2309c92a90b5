// SPDX-License-Identifier: Apache-2.0
// Pair correlation g(r) of a fluid of equal hard discs, the Fourier transform of
// `hard_disc_structure_factor`.
#pragma once

namespace aureole::optics {

/// Returns g(r), with r in disc radii. For r < 2, where discs would overlap, the result is only approximately
/// 0, since the direct correlation function of Rosenfeld (1990) is an approximation in two dimensions.
/// The numerical error for r >= 2 is below 4e-6 up to an area fraction of 0.6, and 1e-5 at 0.7. It is largest
/// at r = 0: 1e-3 and 5e-3.
/// Throws std::domain_error, with the value, unless 0 <= r <= 200 and 0 <= area_fraction <= kMaxAreaFraction.
double hard_disc_pair_correlation(double r, double area_fraction);

}  // namespace aureole::optics
