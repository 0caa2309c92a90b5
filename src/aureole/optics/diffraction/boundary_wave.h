// SPDX-License-Identifier: Apache-2.0
// Boundary diffraction waves: the field behind obstacles and openings as a sum over straight pieces of their outline
// (Maggi 1888; Rubinowicz 1917; Miyamoto & Wolf 1962, "Generalization of the Maggi-Rubinowicz theory of the boundary
// diffraction wave", J. Opt. Soc. Am. 52(6)). Time dependence exp(-i omega t).
//
// For the straight way from a source to an observer, the field over that of the unobstructed wave is
//     u/u0 = V - (1/2 pi) sum over the outline of the integral of c exp(i pi v^2/2) dphi,
// phi the azimuth about the way, V = 1 where the way is free and 0 where it is blocked, v = sqrt(4 delta/lambda) by the
// detour delta of a path by way of the outline, and the outline run with its open side on the left. The plane of vectors
// of length v and azimuth phi is called the Fresnel plane; there a piece of the outline is a straight line if the detour is
// quadratic along it. c = cos(theta/2) joins the sum to the coefficient of geometrical diffraction for light that turns by
// the angle theta (Keller 1962, "Geometrical theory of diffraction", J. Opt. Soc. Am. 52(2)).
#pragma once

#include <complex>
#include <span>

#include "aureole/optics/aperture/polygon_region.h"

namespace aureole::optics {

/// Returns (1/2 pi) times the integral of exp(i pi v^2/(2 cos^2 phi)) dphi from phi = psi to pi/2, with v = r cos(psi): the wave of a
/// half-infinite line in the Fresnel plane that ends at the distance `r` from the origin, where psi in [0, pi/2] is the
/// angle between the end and the foot of the perpendicular on the line. By a table; absolute error below 5e-5.
std::complex<double> corner_wave(double r, double psi);
/// Returns the integral by quadrature, with an absolute error near 1e-12: what the table is made of.
std::complex<double> corner_wave_by_quadrature(double r, double psi);

/// Returns the field behind two half planes one behind the other, over the unobstructed one, by Fresnel's parameter of each
/// alone (negative in its shadow) and their correlation rho = cos(gamma) sqrt(r1 r2/((r1 + L)(r2 + L))): L is the distance
/// between them, r1 and r2 those of the source from the first and of the observer from the second, gamma the angle between
/// their normals about the way. It is a bivariate normal integral of complex argument, by Owen's function (Owen 1956, "Tables
/// for computing bivariate normal probabilities", Ann. Math. Statist. 27(4)), which is a corner wave.
std::complex<double> two_edges_field(double v1, double v2, double rho);

/// Returns the factor by which a second edge, parallel to the first one, changes the first one's boundary wave. `v` is
/// Fresnel's parameter of the first edge alone, `w` that of the second one for light that comes to it or leaves it by way of
/// the first, negative in its shadow. The field of both is 1 or 0 (free or blocked) less the two waves, each with its factor:
/// `two_edges_field`, which Owen's function divides into one part for each edge. `along` is 1 for an endless first edge and 0
/// for a short piece of one; between them the two factors blend.
std::complex<double> wave_past_edge(double v, double w, double along = 1);

/// The obliquity factors c of a piece of an outline at its ends and where the detour of the whole line is smallest.
struct PieceObliquity {
  double begin = 1, end = 1, middle = 1;
};

/// A straight piece of an outline in the Fresnel plane of a unit wavelength: lengths are sqrt(4 delta).
class BoundaryPiece {
public:
  BoundaryPiece(PlanePoint begin, PlanePoint end, PieceObliquity c = {});

  /// Adds to each element of `sum` `factor` times the wave at the wavelength of the same index: (1/2 pi) times the
  /// integral of c exp(i pi v^2/2) dphi over the piece, for phi increasing. Contributions fade out for |v| from `window` to
  /// 4/3 of it, each by the v at which it arises: the stationary one where the detour of the whole line is smallest, and
  /// those of the two ends.
  void add(double factor, std::span<const double> wavelengths, double window,
           std::complex<double>* sum) const;
  /// Returns the wave at one wavelength.
  std::complex<double> wave(double wavelength, double window) const {
    std::complex<double> sum = 0;
    add(1, {&wavelength, 1}, window, &sum);
    return sum;
  }

private:
  /// Number of nodes of Gauss's rule that the piece needs; 0 where its phase changes too much for one.
  int nodes(double wavelength) const;
  void add_by_rule(int nodes, double factor, std::span<const double> wavelengths, double window,
                   std::complex<double>* sum) const;

  double foot_;       ///< distance of the line from the origin
  double radius_[2];  ///< distances of the ends, in the order of increasing azimuth
  double psi_[2];     ///< angles of the ends from the foot, increasing
  double c_[2], c_middle_;
};

/// 1 for |v| <= window, 0 from 4/3 of it on, smooth between them.
double window_weight(double v, double window);

}  // namespace aureole::optics
