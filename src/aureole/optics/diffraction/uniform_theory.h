// SPDX-License-Identifier: Apache-2.0
// The uniform theory of diffraction: waves behind a straight wedge with flat faces (Kouyoumjian & Pathak
// 1974, "A uniform geometrical theory of diffraction for an edge in a perfectly conducting surface", Proc.
// IEEE 62(11), cited as KP). Time dependence exp(-i omega t): values are the complex conjugates of theirs.
//
// Angles are in radians about the edge, from the o-face: phi' to the source, phi to the observer, both in [0,
// n pi], where n pi is the angle outside the wedge. n = 2 is a half plane, n = 3/2 the corner of a block. If
// the source is on a face (phi' = 0 or n pi), direct and reflected light coincide: for hard polarisation
// halve the coefficient, and the sum of direct and reflected light.
#pragma once

#include <complex>

namespace aureole::optics {

/// Returns F(x) = -2 i sqrt(x) exp(-i x) integral from sqrt(x) to infinity of exp(i t^2) dt, x >= 0 (KP
/// equation 26), by Faddeeva's function: sqrt(pi x) exp(-i pi/4) w(sqrt(x) exp(i pi/4)). It tends to 1 for
/// large x.
std::complex<double> transition_function(double x);

/// Reflection coefficients of the two faces for one polarisation: -1 and 1 for metal, soft (electric field
/// along the edge) and hard (magnetic field along it); 0 for a face that absorbs. Other faces have those of
/// Luebbers' heuristic (1984, "Finite conductivity uniform GTD versus knife edge diffraction in prediction of
/// propagation path loss", IEEE Trans. Antennas Propag. 32(1)).
struct WedgeFaces {
  std::complex<double> o = -1, n = -1;
};
inline constexpr WedgeFaces kSoftMetal{-1, -1}, kHardMetal{1, 1};

/// Position of the observer relative to the boundaries of shadow and of reflection: 1 irradiated, 1/2 on the
/// boundary, 0 not irradiated.
struct WedgeLight {
  double direct = 0, reflected_o = 0, reflected_n = 0;
};

class Wedge {
public:
  /// Throws std::domain_error unless 1 < n <= 2.
  explicit Wedge(double n);

  double n() const { return n_; }
  /// Returns the diffraction coefficient D (KP equation 25) in sqrt(length): the diffracted field at the
  /// distance s is (incident field at the edge) x D x spreading x exp(i k s). `distance` is KP's L,
  /// `sin_beta` the sine of the angle between ray and edge. At the boundaries of shadow and of reflection D
  /// has the opposite discontinuity of the geometrical field; on a boundary the result is the mean of both
  /// sides.
  std::complex<double> coefficient(double k, double distance, double sin_beta, double phi, double phi_i,
                                   WedgeFaces faces) const;
  /// Returns Keller's coefficient, without transition functions (Keller 1962, "Geometrical theory of
  /// diffraction", J. Opt. Soc. Am. 52(2)), which is infinite at the boundaries. Metal only.
  std::complex<double> keller_coefficient(double k, double sin_beta, double phi, double phi_i,
                                          bool is_hard) const;
  WedgeLight light(double phi, double phi_i) const;
  /// Returns `coefficient` over that of a half plane that absorbs, at one k L (`k_distance`). Multiplied by
  /// this factor a boundary wave (boundary_wave.h), which is the wave of that half plane, becomes the wave of
  /// this wedge. Both coefficients have their transition functions, so that the factor is finite at the
  /// boundary of the shadow. There it jumps from 1 - e to 1 + e, where e is the sum of the continuous terms
  /// over that of the discontinuous terms: direct light minus the boundary wave times this factor is
  /// continuous. If the observer is not in the shadow, the terms of reflected light fade towards their own
  /// boundaries as the square of their transition function, and are 0 beyond, where the reflected light is a
  /// path of its own.
  std::complex<double> over_half_plane(double k_distance, double phi, double phi_i, WedgeFaces faces) const;

  /// Returns `coefficient`, with one reflection coefficient of both faces, over the sum of two coefficients of a
  /// half plane that absorbs, at one k L: for the source, and for its image in the o-face times `face`. If light
  /// runs along the o-face to or from another edge of that face, an integral over both half planes has that sum in
  /// place of the wedge's coefficient. At grazing incidence both vanish together if `face` is -1.
  std::complex<double> over_half_plane_and_image(double k_distance, double phi, double phi_i,
                                                 std::complex<double> face) const;

  /// Returns the terms of KP equation 25 for this wedge, minus those of half planes that absorb: for the source, and
  /// for its image in the o-face times faces.o. All poles but those of the n-face cancel: at the boundaries of shadow
  /// and of reflection by the o-face the result is continuous and finite. Over `half_plane_terms`, it is what the
  /// n-face adds to a wave that has the image of the o-face already. If the observer is not in the shadow, the term of
  /// light that the n-face reflects fades as in `over_half_plane`.
  std::complex<double> terms_beside_image(double k_distance, double phi, double phi_i,
                                          WedgeFaces faces) const;

  /// Returns the field, geometrical and diffracted, at the distance rho from the edge, of a plane wave that
  /// is incident perpendicularly to the edge with amplitude 1 and phase 0 there. For a half plane of metal it
  /// is Sommerfeld's exact solution.
  std::complex<double> plane_wave_field(double k, double rho, double phi, double phi_i,
                                        WedgeFaces faces) const;

private:
  /// Returns the reflection coefficient of a face whose boundary of reflection is passed at phi + phi_i = `boundary`,
  /// the observer being on its dark side by `from_boundary`. It is weighted by the square of its transition function
  /// over that at the boundary of the shadow, where the reflected term counts in full. The latter is the geometric
  /// mean of its values for this source and for a source at the observer's angle, so that both may be exchanged.
  static std::complex<double> faded(std::complex<double> face, double k_distance, double phi, double phi_i,
                                    double boundary, double from_boundary);

  double n_;
};

/// Returns the terms of KP equation 25 for a half plane that absorbs: of its coefficient without the constant.
/// `difference`: the angle from source to observer about the edge. It is moved off the boundary of the shadow.
std::complex<double> half_plane_terms(double k_distance, double difference);

/// KP's distance parameter L: s sin^2(beta) for a plane wave, and s s_i sin^2(beta)/(s + s_i) for a point
/// source at the distance s_i from the edge.
double plane_wave_distance(double s, double sin_beta);
double point_source_distance(double s_i, double s, double sin_beta);
/// Spreading factors from the edge to the distance s: sqrt(s_i/(s (s + s_i))) for a point source, 1/sqrt(s)
/// for a plane wave, oblique or not.
double point_source_spreading(double s_i, double s);
double plane_wave_spreading(double s);

}  // namespace aureole::optics
