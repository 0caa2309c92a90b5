// SPDX-License-Identifier: Apache-2.0
// The intensity of a layer of scatterers at independent positions, which may overlap (the Boolean model;
// Torquato, Random Heterogeneous Materials, 2002, section 5.1).
//
// Transmittances of scatterers multiply: light passes a point of opaque discs with the product of 1 - A
// over all discs, and a point of a screen with openings with 1 minus that product. With rho scatterers per
// area, w(r) the mean autocorrelation of their transmittance A and Fr = rho times their mean area, both have
// the autocovariance exp(-2 Fr) (exp(rho w(r)) - 1), whose Fourier transform is the intensity J(q). For small
// Fr it is rho times the transform W of w, the mean of |F|^2, as if scatterers did not overlap; at Fr = 0.5 it
// is 15 % lower than that in the centre, relative to its total, and has no dark rings.
//
// Quantities are scale-free as in scatterer_mixture.h: lengths are relative to the correlation radius a, and
// u = q a.
#pragma once

#include <functional>
#include <vector>

#include "aureole/core/parallel_for.h"

namespace aureole::optics {

class OverlappingScatterers {
public:
  /// Returns W at (ux, uy), in units of a^4. It need not be thread-safe.
  using Independent = std::function<double(double ux, double uy)>;

  /// `mean_square` is w(0), the mean integral of A^2, and `reach` the radius of a circle that contains each
  /// scatterer, in units of a^2 and of a. `density` is rho a^2 > 0. With `isotropic` W depends on |u| alone.
  OverlappingScatterers(const Independent& independent, double mean_square, double reach, double density,
                        bool isotropic, const ParallelFor& parallel_for = serial_for);

  /// Returns the intensity per scatterer and area, without the factor exp(-2 Fr), from W at the same (ux,
  /// uy): the transform of (exp(rho w) - 1)/rho.
  double eval(double ux, double uy, double independent) const;
  /// Returns the integral of `eval` over the plane of u, divided by 2 pi.
  double total() const;

private:
  double edge(double ux, double uy) const;

  double density_, growth_;  ///< rho a^2, and the factor exp(rho w(0))
  double mean_square_, rate_;
  /// The transform of (exp(rho w) - 1 - growth rho w)/rho at steps of 1/rate_ of ux, and of uy >= 0 unless
  /// isotropic: row by row, with a border of one node.
  bool isotropic_;
  int columns_, rows_;
  std::vector<double> nodes_;
};

}  // namespace aureole::optics
