// SPDX-License-Identifier: Apache-2.0
// The error function of complex arguments by libcerf (Johnson & Wuttke), with relative errors near 1e-13, and
// functions derived from it that edge diffraction needs. Time dependence exp(-i omega t).
#pragma once

#include <complex>

namespace aureole::optics {

/// Returns the Faddeeva function w(z) = exp(-z^2) erfc(-i z).
std::complex<double> faddeeva(std::complex<double> z);

/// Returns the integral from a to b of exp(-t^2 + 2 i beta t) dt for real a, b and beta. It is stable
/// wherever it is not negligible (Abramowitz & Stegun 1964, 7.4.2).
std::complex<double> gaussian_wave_integral(double a, double b, double beta);

/// Returns the Fresnel integral C(v) + i S(v), of exp(i pi t^2/2) dt from 0 to v (Abramowitz & Stegun 1964,
/// 7.3). Absolute error 1e-15.
std::complex<double> fresnel_integral(double v);

/// Returns the field behind an opaque half plane over the unobstructed field, in Fresnel's approximation:
/// (1/sqrt(2)) exp(-i pi/4) times the integral of exp(i pi t^2/2) from -v to infinity (Born & Wolf,
/// Principles of Optics, 7th ed. 1999, 8.7.3).
/// The Fresnel parameter v is negative in the shadow: v = -h sqrt(2 (1/d1 + 1/d2)/lambda) if the edge is h
/// above the line from the source, at the distance d1 from the source and d2 from the observer. The result
/// has full relative accuracy also deep in the shadow.
std::complex<double> knife_edge_field(double v);
/// Returns |knife_edge_field|^2, the intensity relative to the intensity without the half plane; 1/4 at the
/// shadow boundary.
double knife_edge_intensity(double v);

}  // namespace aureole::optics
