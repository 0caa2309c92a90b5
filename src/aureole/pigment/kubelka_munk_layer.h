// SPDX-License-Identifier: Apache-2.0
// Kubelka and Munk's theory of a plane layer that absorbs and scatters diffuse light: two fluxes, one down
// and one up, with
//     dI/dx = -(K + S) I + S J,    -dJ/dx = -(K + S) J + S I,
// x being the depth (P. Kubelka, F. Munk, Z. Tech. Phys. 12, 1931; P. Kubelka, J. Opt. Soc. Am. 38, 1948).
//
// K and S are per length, in the inverse of the unit of thickness, whatever that is. Reflectances are those
// for diffuse light within the binder, without the interface to air (saunderson.h adds it). All functions
// throw std::domain_error, with the value, for arguments out of their range.
#pragma once

namespace aureole::pigment {

/// Absorption K and scattering S of diffuse light per length, both >= 0.
struct Coefficients {
  double k = 0, s = 0;

  /// K/S; infinite where S = 0, and 0 where both are.
  double ratio() const;
};

/// Reflected and transmitted fractions of diffuse light of a layer that has nothing behind it. Both are the
/// same from either side.
struct LayerTransfer {
  double reflectance = 0, transmittance = 1;
};

/// Kubelka 1948, (18) and (24), in forms that stay exact for S -> 0 (Beer and Lambert), for K -> 0, where R =
/// S X/(1 + S X), and for thick layers; a thickness of infinity is allowed. K, S and the thickness are >= 0.
LayerTransfer layer(Coefficients c, double thickness);

/// Reflectance of a layer over a substrate of diffuse reflectance in [0, 1], light that goes back and forth
/// between them included: R + T^2 Rg/(1 - R Rg).
double reflectance_over(LayerTransfer layer, double substrate);

/// The layer with another one below it.
LayerTransfer stacked(LayerTransfer upper, LayerTransfer lower);

/// Downward and upward flux within a layer, for an incident flux of one.
struct Fluxes {
  double down = 0, up = 0;

  /// R(x), the reflectance of what lies below.
  double reflectance() const { return up / down; }
};

/// At `depth` in [0, thickness] in a layer over a substrate.
Fluxes fluxes_within(Coefficients c, double thickness, double substrate, double depth);

/// Reflectance R_inf of a layer so thick that nothing behind it is seen, by K/S in [0, inf].
double opaque_reflectance(double k_over_s);

/// K/S of an opaque layer, (1 - R)^2/(2 R), for R in (0, 1].
double k_over_s(double opaque_reflectance);

}  // namespace aureole::pigment
