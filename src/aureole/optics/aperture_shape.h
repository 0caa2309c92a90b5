// SPDX-License-Identifier: Apache-2.0
// `ApertureShape`: what diffraction needs to know of one opening (or of one opaque disc, by Babinet's
// principle). Lengths in one unit of the caller's choice, q in rad per that unit; the scatterer's position,
// which the correlation is about, is the origin.
#pragma once

#include <complex>

namespace aureole::optics {

class ApertureShape {
public:
  virtual ~ApertureShape() = default;

  /// Integral of A(x), the area of a shape without grey.
  virtual double area() const = 0;
  /// Integral of A(x)^2; the same but for grey masks.
  virtual double squared_area() const { return area(); }
  /// Radius of the smallest circle about the origin that holds the shape.
  virtual double bounding_radius() const = 0;
  /// F(q) = integral of A(x) exp(-i q.x) dx dy; F(0) = area() (Goodman, Introduction to Fourier Optics, 4th
  /// ed. 2017, chapter 4).
  virtual std::complex<double> transform(double qx, double qy) const = 0;
  /// F depends on |q| alone.
  virtual bool is_circular() const { return false; }
};

}  // namespace aureole::optics
