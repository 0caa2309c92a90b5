// SPDX-License-Identifier: Apache-2.0
// The functions of radius in the series of spheres: psi_n(z) = z j_n(z) and its logarithmic derivative, by
// recurrences in the directions in which they are stable.
#pragma once

#include <complex>
#include <vector>

namespace aureole::optics {

/// Number of terms after which the series has converged in double precision (Wiscombe, "Improved Mie
/// scattering algorithms", 1980, equation 26, with a few more).
int term_count(double x);

/// psi_n'(z)/psi_n(z) for n = 0 ... count, by downward recurrence. Errors of its start decay only at n > |z|,
/// over some |z|^(1/3) terms: a start at |z| itself gives wrong results for large absorbing spheres.
std::vector<std::complex<double>> logarithmic_derivatives(std::complex<double> z, int count);

/// psi_n(x) = x j_n(x) for n = 0 ... count: upward as long as that is stable, n < x, and from there by the
/// ratios psi_n/psi_(n-1) of a downward recurrence.
std::vector<double> riccati_bessel(double x, int count);

}  // namespace aureole::optics
