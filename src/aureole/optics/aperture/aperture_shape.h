// SPDX-License-Identifier: Apache-2.0
// `ApertureShape`: an aperture in an opaque screen or, by Babinet's principle, an opaque disc, given by its
// transmittance A(x) in [0, 1] and the Fourier transform of A. Lengths are in one unit of the caller's
// choice, q in rad per that unit. The origin is the scatterer's position, to which structure factors refer.
#pragma once

#include <complex>

namespace aureole::optics {

class ApertureShape {
public:
  virtual ~ApertureShape() = default;

  /// Returns the integral of A(x), which is the area of a shape without partial transmittance.
  virtual double area() const = 0;
  /// Returns the integral of A(x)^2; equal to the area unless A has values between 0 and 1.
  virtual double squared_area() const { return area(); }
  /// Returns the radius of the smallest circle about the origin that contains the shape.
  virtual double bounding_radius() const = 0;
  /// Returns F(q) = integral of A(x) exp(-i q.x) dx dy; F(0) = area() (Goodman, Introduction to Fourier
  /// Optics, 4th ed. 2017, chapter 4).
  virtual std::complex<double> transform(double qx, double qy) const = 0;
  /// Whether F depends on |q| alone.
  virtual bool is_circular() const { return false; }
};

}  // namespace aureole::optics
