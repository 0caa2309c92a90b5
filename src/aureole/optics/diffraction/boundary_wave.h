// SPDX-License-Identifier: Apache-2.0
// Boundary diffraction waves: the field behind obstacles and openings as a sum over straight pieces of their
// outline (Maggi 1888; Rubinowicz 1917; Miyamoto & Wolf 1962, "Generalization of the Maggi-Rubinowicz theory
// of the boundary diffraction wave", J. Opt. Soc. Am. 52(6)). Time dependence exp(-i omega t).
//
// For the straight segment from a source to an observer, the field over that of the unobstructed wave is
//     u/u0 = V - (1/2 pi) sum over the outline of the integral of c exp(i pi v^2/2) dphi,
// where phi is the azimuth about the segment and V is 1 if the segment is unoccluded and 0 if it is occluded.
// v = sqrt(4 delta/lambda) is Fresnel's parameter, from the detour delta of a path by way of the outline. The
// outline is traversed with its open side on the left. The plane of vectors of length v and azimuth phi is
// called the Fresnel plane. A piece of the outline is a straight line there if the detour is quadratic along
// it. The obliquity factor c = cos(theta/2), theta being the angle by which the light turns, makes the sum
// agree with the coefficient of geometrical diffraction at large angles (Keller 1962, "Geometrical theory of
// diffraction", J. Opt. Soc. Am. 52(2)).
#pragma once

#include <complex>
#include <span>

#include "aureole/optics/aperture/polygon_region.h"

namespace aureole::optics {

/// Returns the wave of a half-infinite line in the Fresnel plane, (1/2 pi) times the integral of exp(i pi
/// v^2/(2 cos^2 phi)) dphi from phi = psi to pi/2, with v = r cos(psi). The line ends at the distance `r`
/// from the origin; psi in [0, pi/2] is the angle between the end and the foot of the perpendicular on the
/// line. Evaluated by a table, with an absolute error below 5e-5.
std::complex<double> corner_wave(double r, double psi);
/// Returns `corner_wave` by quadrature, with an absolute error near 1e-12. The table holds its values.
std::complex<double> corner_wave_by_quadrature(double r, double psi);

/// Returns the field behind two half planes one behind the other, over the unobstructed field. `v1` and `v2`
/// are Fresnel's parameters of each edge alone, negative in its shadow. Their correlation is rho = cos(gamma)
/// sqrt(r1 r2/((r1 + L)(r2 + L))): L is the distance between the edges, r1 that of the source from the first
/// edge, r2 that of the observer from the second, gamma the angle between the edges' normals about the
/// segment. The field is a bivariate normal integral of complex argument, by Owen's function (Owen 1956,
/// "Tables for computing bivariate normal probabilities", Ann. Math. Statist. 27(4)), which is a corner wave.
std::complex<double> two_edges_field(double v1, double v2, double rho);

/// Returns the factor by which a second edge, parallel to the first one, changes the first one's boundary
/// wave. `v` is Fresnel's parameter of the first edge alone. `w` is that of the second edge for light that
/// arrives or leaves by way of the first, negative in the second edge's shadow. The field behind both is V
/// minus the two waves, each multiplied by its factor; it equals `two_edges_field`, since Owen's function
/// splits that field into one part for each edge. `along` is 1 for an infinite first edge and 0 for a short
/// piece of one; between them the two factors are interpolated.
std::complex<double> wave_past_edge(double v, double w, double along = 1);

/// The obliquity factors c at the ends of a piece of an outline and at the smallest detour of its whole line.
struct PieceObliquity {
  double begin = 1, end = 1, middle = 1;
};

/// A straight piece of an outline in the Fresnel plane of a unit wavelength, where lengths are sqrt(4 delta).
class BoundaryPiece {
public:
  BoundaryPiece(PlanePoint begin, PlanePoint end, PieceObliquity c = {});

  /// Adds `factor` times the wave at wavelengths[i] to sum[i]: (1/2 pi) times the integral of c exp(i pi
  /// v^2/2) dphi over the piece, for increasing phi. Contributions fade out for |v| from `window` to 4/3
  /// `window`, each by the v at which it arises: the stationary one by v at the smallest detour of the whole
  /// line, and those of the two ends by v there.
  void add(double factor, std::span<const double> wavelengths, double window,
           std::complex<double>* sum) const;
  /// Returns the wave at one wavelength.
  std::complex<double> wave(double wavelength, double window) const {
    std::complex<double> sum = 0;
    add(1, {&wavelength, 1}, window, &sum);
    return sum;
  }

private:
  /// Returns the number of nodes of the Gauss rule that the piece needs, or 0 if its phase changes too much
  /// for one.
  int nodes(double wavelength) const;
  void add_by_rule(int nodes, double factor, std::span<const double> wavelengths, double window,
                   std::complex<double>* sum) const;

  double foot_;       ///< distance of the line from the origin
  double radius_[2];  ///< distances of the ends, in the order of increasing azimuth
  double psi_[2];     ///< azimuths of the ends from the foot, increasing
  double c_[2], c_middle_;
};

/// Returns a smooth rise: 0 for t <= 0, 1 for t >= 1, and a cubic polynomial between them.
double smooth_step(double t);

/// Returns a smooth weight: 1 for |v| <= window, 0 for |v| >= 4/3 window.
double window_weight(double v, double window);

}  // namespace aureole::optics
