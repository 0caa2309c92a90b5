// SPDX-License-Identifier: Apache-2.0
// Bessel functions by Boost.Math, with errors near 1e-15 of their envelope. By default Boost computes in long
// double, several times slower, for digits that are rounded away. Only this file selects double and compiles
// these functions.
#pragma once

namespace aureole::optics {

/// Returns J_0(x).
double bessel_j0(double x);
/// Returns J_1(x).
double bessel_j1(double x);
/// Returns I_0(x), the modified Bessel function of the first kind.
double bessel_i0(double x);

}  // namespace aureole::optics
