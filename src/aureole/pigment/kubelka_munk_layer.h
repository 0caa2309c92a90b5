// SPDX-License-Identifier: Apache-2.0
// Kubelka and Munk's theory of a plane layer that absorbs and scatters diffuse light, with a downward flux I
// and an upward flux J:
//     dI/dx = -(K + S) I + S J,    -dJ/dx = -(K + S) J + S I,
// where x is the depth (P. Kubelka, F. Munk, Z. Tech. Phys. 12, 1931; P. Kubelka, J. Opt. Soc. Am. 38, 1948).
//
// K and S are per length, in the inverse of any unit of thickness. Reflectances are for diffuse light within
// the binder, without the interface to air (see saunderson.h). All functions throw std::domain_error, with
// the value, for arguments out of range.
#pragma once

namespace aureole::pigment {

/// Absorption K and scattering S of diffuse light per length, both >= 0.
struct Coefficients {
  double k = 0, s = 0;

  /// K/S; infinite if S = 0, and 0 if both are 0.
  double ratio() const;
};

/// Reflected and transmitted fractions of diffuse light for a free layer. Both are equal from either side.
struct LayerTransfer {
  double reflectance = 0, transmittance = 1;
};

/// Reflectance and transmittance by Kubelka 1948, (18) and (24), in forms that are exact for S -> 0 (Beer and
/// Lambert), for K -> 0, where R = S X/(1 + S X), and for thick layers, infinite ones included. K, S and the
/// thickness X are >= 0.
LayerTransfer layer(Coefficients c, double thickness);

/// Reflectance of a layer over a substrate of diffuse reflectance in [0, 1], with multiple reflections
/// between them: R + T^2 Rg/(1 - R Rg).
double reflectance_over(LayerTransfer layer, double substrate);

/// Combines a layer with another one below it.
LayerTransfer stacked(LayerTransfer upper, LayerTransfer lower);

/// Downward and upward flux within a layer, for an incident flux of one.
struct Fluxes {
  double down = 0, up = 0;

  /// R(x), the reflectance of everything below.
  double reflectance() const { return up / down; }
};

/// Fluxes at `depth` in [0, thickness] in a layer over a substrate.
Fluxes fluxes_within(Coefficients c, double thickness, double substrate, double depth);

/// Reflectance R_inf of an opaque (infinitely thick) layer, by K/S in [0, inf].
double opaque_reflectance(double k_over_s);

/// K/S of an opaque layer, (1 - R)^2/(2 R), for R in (0, 1].
double k_over_s(double opaque_reflectance);

}  // namespace aureole::pigment
