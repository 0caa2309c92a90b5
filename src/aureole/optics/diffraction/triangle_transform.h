// SPDX-License-Identifier: Apache-2.0
// Fourier transform of an amplitude that is linear over a triangle, in closed form.
#pragma once

#include <array>
#include <complex>
#include <span>

#include "aureole/optics/aperture/polygon_region.h"

namespace aureole::optics {

/// A triangle, in either orientation, and the values of a linear function at its corners.
struct LinearTriangle {
  std::array<PlanePoint, 3> corner;
  std::array<std::complex<double>, 3> value;

  double area() const;
};

/// Returns F(q) = integral of value(x) exp(-i q.x) dx dy, exact for every q: a divided difference of the
/// exponential at the phases of the corners (formula of Hermite and Genocchi; de Boor 2005, "Divided
/// differences", Surveys in Approximation Theory 1, section 9). If phases lie close together it is computed
/// by its power series (McCurdy, Ng & Parlett 1984, "Accurate computation of divided differences of the
/// exponential function", Math. Comp. 43(168)), so that no direction of q is singular. The absolute error is
/// below 1e-14 of the area times the largest value, plus that of rounding the phases q.x. q is in rad per
/// unit of length.
std::complex<double> transform(const LinearTriangle& triangle, PlanePoint q);
/// Returns the sum over triangles that do not overlap.
std::complex<double> transform(std::span<const LinearTriangle> triangles, PlanePoint q);

/// Returns the integral of |value|^2 over a triangle: |S|/6 Re sum over pairs j <= l of v_j conj(v_l), S
/// being the area.
double power(const LinearTriangle& triangle);
double power(std::span<const LinearTriangle> triangles);

/// Integrals of value x^a y^b, a + b <= 2, which determine the far field near q = 0.
struct AmplitudeMoments {
  std::complex<double> total, x, y, xx, xy, yy;
};
AmplitudeMoments amplitude_moments(std::span<const LinearTriangle> triangles);

}  // namespace aureole::optics
