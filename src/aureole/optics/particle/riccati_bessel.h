// SPDX-License-Identifier: Apache-2.0
// Radial functions of the Mie series: psi_n(z) = z j_n(z) and its logarithmic derivative, by recurrences in
// their stable directions.
#pragma once

#include <complex>
#include <vector>

namespace aureole::optics {

/// Returns the number of terms after which the series has converged in double precision (Wiscombe, "Improved
/// Mie scattering algorithms", 1980, equation 26, with a few more).
int term_count(double x);

/// Returns psi_n'(z)/psi_n(z) for n = 0 ... count, by downward recurrence. Errors of the starting value decay
/// only for n > |z|, over some |z|^(1/3) terms: starting at |z| itself gives wrong results for large
/// absorbing spheres.
std::vector<std::complex<double>> logarithmic_derivatives(std::complex<double> z, int count);

/// Returns psi_n(x) = x j_n(x) for n = 0 ... count. The recurrence is upward while that is stable, n < x;
/// beyond, ratios psi_n/psi_(n-1) come from a downward recurrence.
std::vector<double> riccati_bessel(double x, int count);

}  // namespace aureole::optics
