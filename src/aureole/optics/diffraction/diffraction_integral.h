// SPDX-License-Identifier: Apache-2.0
// Scalar diffraction integrals over an opening in an opaque plane screen, by quadrature whose steps follow
// the phase. They are slow and exact: approximations are tested against them. Time dependence exp(-i omega
// t).
#pragma once

#include <array>
#include <complex>
#include <functional>
#include <optional>
#include <vector>

#include "aureole/optics/aperture/polygon_region.h"

namespace aureole::optics {

/// An opening in the plane z = 0.
class FlatOpening {
public:
  static FlatOpening polygon(PolygonRegion region);
  /// A ring about the origin, or a disc if `inner` is 0. Throws std::domain_error unless 0 <= inner < radius.
  static FlatOpening disc(double radius, double inner = 0);

  /// Returns the integral of value(x, y) over the opening, by Gauss rules on cells that are at most step(x,
  /// y) wide along x and along y; `step` is evaluated at both ends of a cell.
  std::complex<double> integral(const std::function<std::complex<double>(double, double)>& value,
                                const std::function<double(double, double)>& step) const;

private:
  std::vector<double> intervals(double y) const;

  std::optional<PolygonRegion> region_;
  double radius_ = 0, inner_ = 0;
};

/// The wave incident from z < 0: a plane wave exp(i k d.x), or a spherical wave exp(i k r)/r from a point.
struct ScreenSource {
  static ScreenSource plane_wave(std::array<double, 3> direction);
  static ScreenSource point(std::array<double, 3> position);

  bool is_point = false;
  std::array<double, 3> at;  ///< unit direction with z > 0, or position with z < 0
};

/// Returns the first integral of Rayleigh & Sommerfeld at a point with z > 0,
///   U = (1/2 pi) integral of U_0 (z/r) (1/r - i k) exp(i k r)/r dS
/// (Goodman, Introduction to Fourier Optics, 4th ed. 2017, 3.5). It is exact if the field in the opening is
/// that of the source and the field on the screen is 0. The relative error is near 1e-10 where waves do not
/// cancel; the time grows with the number of Fresnel zones.
std::complex<double> rayleigh_sommerfeld(const FlatOpening& opening, const ScreenSource& source,
                                         std::array<double, 3> point, double k);
/// Returns Kirchhoff's integral, (1/4 pi) integral of (G dU_0/dz - U_0 dG/dz) dS with G = exp(i k r)/r
/// (Goodman 2017, 3.4).
std::complex<double> kirchhoff(const FlatOpening& opening, const ScreenSource& source,
                               std::array<double, 3> point, double k);
/// Returns Fraunhofer's integral, F(q) = integral of exp(-i q.x) dS, q in rad per length. Far behind the
/// opening, in the direction that differs by q/k from that of the plane wave, U = k/(2 pi i) exp(i k R)/R F.
std::complex<double> fraunhofer(const FlatOpening& opening, PlanePoint q);

}  // namespace aureole::optics
