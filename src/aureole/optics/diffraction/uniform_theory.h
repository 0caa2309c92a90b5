// SPDX-License-Identifier: Apache-2.0
// The uniform theory of diffraction: waves behind a straight wedge with flat faces (Kouyoumjian & Pathak 1974, "A uniform geometrical
// theory of diffraction for an edge in a perfectly conducting surface", Proc. IEEE 62(11), written KP). Time dependence
// exp(-i omega t): values are the complex conjugates of theirs.
//
// Angles in radians about the edge, from the o-face: phi' to the source, phi to the observer, both in [0, n pi], where n pi is the
// angle outside the wedge; n = 2 is a half plane, n = 3/2 the corner of a block. Where the source is on a face (phi' = 0 or n pi) direct
// and reflected light are one: take half of the coefficient, for hard polarisation, and of the sum of both lights.
#pragma once

#include <complex>

namespace aureole::optics {

/// F(x) = -2 i sqrt(x) exp(-i x) integral from sqrt(x) on of exp(i t^2) dt, x >= 0 (KP equation 26), by Faddeeva's function:
/// sqrt(pi x) exp(-i pi/4) w(sqrt(x) exp(i pi/4)). 1 for large x.
std::complex<double> transition_function(double x);

/// Reflection of the faces for one polarisation: -1 and 1 are metal, soft (electric field along the edge) and hard; others by
/// the heuristic of Luebbers 1984, "Finite conductivity uniform GTD versus knife edge diffraction in prediction of propagation path
/// loss", IEEE Trans. Antennas Propag. 32(1); 0 and 0: a face that absorbs.
struct WedgeFaces {
  std::complex<double> o = -1, n = -1;
};
inline constexpr WedgeFaces kSoftMetal{-1, -1}, kHardMetal{1, 1};

/// Where the observer is relative to the boundaries of shadow and reflection: 1 lit, 1/2 on the boundary, 0 dark.
struct WedgeLight {
  double direct = 0, reflected_o = 0, reflected_n = 0;
};

class Wedge {
public:
  /// Throws std::domain_error unless 1 < n <= 2.
  explicit Wedge(double n);

  double n() const { return n_; }
  /// D (KP equation 25), in sqrt(length): diffracted field at the distance s = incident field at the edge x D x spreading x
  /// exp(i k s). `distance` is KP's L, `sin_beta` the sine of the angle between ray and edge. Discontinuous at the boundaries of
  /// shadow and reflection as the geometrical field is, the opposite way; on a boundary the mean of both sides.
  std::complex<double> coefficient(double k, double distance, double sin_beta, double phi, double phi_i,
                                   WedgeFaces faces) const;
  /// Keller's coefficient, without transition functions (Keller 1962, "Geometrical theory of diffraction", J. Opt. Soc.
  /// Am. 52(2)): infinite at the boundaries. Metal only.
  std::complex<double> keller_coefficient(double k, double sin_beta, double phi, double phi_i,
                                          bool is_hard) const;
  WedgeLight light(double phi, double phi_i) const;
  /// Returns `coefficient` over that of a half plane that absorbs, at one k L (`k_distance`): the factor that makes a boundary wave
  /// (boundary_wave.h), which is the wave of that half plane, the wave of this wedge. Both have their transition functions, so that
  /// it is finite at the boundary of the shadow. There it jumps from 1 - e to 1 + e, e the terms that do not jump over those that do,
  /// so that direct light less the boundary wave times this factor is continuous. Where the observer is not in the shadow, the terms of reflected light fade towards their own boundaries, as the square of their transition function, and are 0
  /// beyond: there the reflected light is a path of its own.
  std::complex<double> over_half_plane(double k_distance, double phi, double phi_i, WedgeFaces faces) const;

  /// A plane wave of amplitude 1 and phase 0 at the edge comes across it: the field at the distance rho, geometrical and diffracted.
  /// Of a half plane of metal it is Sommerfeld's exact solution.
  std::complex<double> plane_wave_field(double k, double rho, double phi, double phi_i,
                                        WedgeFaces faces) const;

private:
  double n_;
};

/// KP's L for a plane wave, s sin^2(beta), and for a point source at the distance s_i before the edge: s s_i sin^2(beta)/(s + s_i).
double plane_wave_distance(double s, double sin_beta);
double point_source_distance(double s_i, double s, double sin_beta);
/// Spreading: of a wave from a point source, sqrt(s_i/(s (s + s_i))), field at the edge to field at s; plane wave, oblique or not: 1/sqrt(s).
double point_source_spreading(double s_i, double s);
double plane_wave_spreading(double s);

}  // namespace aureole::optics
