// SPDX-License-Identifier: Apache-2.0
// Waves around blocks of metal in two dimensions by a boundary integral equation: a reference that shares nothing with
// the renderer. Lengths are in wavelengths, the time dependence is exp(-i omega t).
#pragma once

#include <array>
#include <complex>
#include <vector>

namespace aureole {

/// A rectangle of metal with sides along x and y.
struct MetalBlock {
  double x0, y0, x1, y1;

  bool contains(double x, double y) const { return x > x0 && x < x1 && y > y0 && y < y1; }
};

/// A plane wave of amplitude 1 at blocks that do not touch each other. The unknowns, one for each element of the
/// boundary, are the normal derivative of the field if it vanishes there (soft), and the field if its normal derivative
/// vanishes (hard). Points inside the blocks, where the field of the boundary cancels the wave, make the solution unique
/// at resonances of the inside; it is that of least squares.
class MetalSolver {
public:
  /// `angle` [radians]: the direction of travel from the x axis. `per_wavelength`: elements per wavelength; they are
  /// shorter at corners.
  MetalSolver(const std::vector<MetalBlock>& blocks, double angle, bool is_hard, int per_wavelength);

  std::size_t elements() const { return elements_.size(); }
  /// Returns the field at a point outside.
  std::complex<double> field(double x, double y) const;

private:
  using Complex = std::complex<double>;
  using Point = std::array<double, 2>;
  struct Element {
    Point begin, along, normal;
    double length;

    Point at(double t) const { return {begin[0] + t * along[0], begin[1] + t * along[1]}; }
  };
  Complex incident(const Point& p) const;
  /// Returns the kernel of the unknown, at the point `p`, of a source at `q` of an element.
  Complex kernel(const Point& p, const Point& q, const Element& element) const;
  /// Returns the integral of the kernel over an element. Near elements are cut finely towards the nearest point.
  Complex integral(const Point& p, const Element& element) const;

  std::vector<Element> elements_;
  std::vector<Complex> unknown_;
  Point direction_;
  bool is_hard_;
};

}  // namespace aureole
