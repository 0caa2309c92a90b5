// SPDX-License-Identifier: Apache-2.0
// Fourier transforms of apertures, F(q) = integral of A(x) exp(-i q.x) dx dy with A in [0, 1]: the far field
// of one aperture up to a wave factor (Goodman, Introduction to Fourier Optics, 4th ed. 2017, chapter 4).
// Lengths are in any unit, q in rad per that unit, F in that unit squared; F(0) is the area.
#pragma once

namespace aureole::optics {

/// Returns the transform of a circle over its area, 2 J1(u)/u with u = |q| radius (Airy pattern: Born & Wolf,
/// Principles of Optics, 7th ed. 1999, section 8.5.2). It is even in u and 1 at 0. The relative error is near
/// 1e-15 away from its zeros.
double circle_transform(double u);

/// Returns the transform of a circle centred at the origin, pi radius^2 circle_transform(|q| radius). Throws
/// std::domain_error unless radius is positive and finite.
double circle_aperture_transform(double q, double radius);

}  // namespace aureole::optics
