// SPDX-License-Identifier: Apache-2.0
// Bessel functions by Boost.Math, to some 1e-15 of their envelope. Boost would compute in long double by
// default, several times slower for digits that are rounded away; here is the one place that asks it not to,
// and that compiles it.
#pragma once

namespace aureole::optics {

/// J_0(x).
double bessel_j0(double x);
/// J_1(x).
double bessel_j1(double x);
/// I_0(x), the modified Bessel function of the first kind.
double bessel_i0(double x);

}  // namespace aureole::optics
