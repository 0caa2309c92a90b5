// SPDX-License-Identifier: Apache-2.0
// The error function of complex arguments by libcerf (Johnson & Wuttke), relative errors near 1e-13, and what waves at edges
// need of it. Time dependence exp(-i omega t).
#pragma once

#include <complex>

namespace aureole::optics {

/// Faddeeva's function w(z) = exp(-z^2) erfc(-i z).
std::complex<double> faddeeva(std::complex<double> z);

/// Integral from a to b of exp(-t^2 + 2 i beta t) dt, stable wherever it is not negligible (Abramowitz & Stegun 1964,
/// 7.4.2). a, b and beta are real.
std::complex<double> gaussian_wave_integral(double a, double b, double beta);

/// C(v) + i S(v), integral from 0 to v of exp(i pi t^2/2) dt (Abramowitz & Stegun 1964, 7.3). Absolute error 1e-15.
std::complex<double> fresnel_integral(double v);

/// Field behind an opaque half plane over that without it, by Fresnel's approximation: (1/sqrt(2)) exp(-i pi/4) times the
/// integral of exp(i pi t^2/2) from -v on (Born & Wolf, Principles of Optics, 7th ed. 1999, 8.7.3). Fresnel's number v is
/// negative in the shadow: v = -h sqrt(2 (1/d1 + 1/d2)/lambda) where the edge stands h above the straight way from the source, d1
/// before and d2 behind it. Full relative accuracy also deep in the shadow.
std::complex<double> knife_edge_field(double v);
/// Its square: intensity over that without the half plane; 1/4 at the boundary of the shadow.
double knife_edge_intensity(double v);

}  // namespace aureole::optics
