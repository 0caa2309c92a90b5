// SPDX-License-Identifier: Apache-2.0
// The interface between a paint's binder and air, for diffuse light: J. L. Saunderson, Calculation of the
// color of pigmented plastics, J. Opt. Soc. Am. 32, 1942. "Inner" quantities are those of the pigmented layer
// within the binder, "outer" ones those that an instrument measures.
#pragma once

#include "aureole/pigment/kubelka_munk_layer.h"

namespace aureole::pigment {

/// R_outer = seen + through R/(1 - k2 R). The default is no interface.
struct Surface {
  double seen = 0;     ///< light that the interface itself reflects and that the instrument counts
  double through = 1;  ///< passes the interface in and out; (1 - k1)(1 - k2) in Saunderson's form
  double k2 = 0;       ///< reflectance of the interface for diffuse light from within
};

/// Light reflected specularly is counted ("SCI") or trapped ("SCE").
enum class Specular { included, excluded };

/// Saunderson's own form: k1 the reflectance of the interface from outside as the instrument sees it, k2 from
/// within; both in [0, 1).
Surface saunderson_surface(double k1, double k2, Specular specular);

/// How an instrument lights and sees a sample.
enum class Geometry {
  diffuse_diffuse,  ///< lit from everywhere, all reflected light measured: k1 is .0918 for an index of 1.5
  diffuse_8,  ///< lit by a sphere, seen at 8 degrees (d:8, or 8:d): k1 is Fresnel's reflectance at 8 degrees
  angle_45_0  ///< lit at 45 degrees, seen along the normal: no specular light in any case
};

/// A smooth interface to a binder of relative index n >= 1: k2 is the integral of Fresnel's reflectance for
/// diffuse light from within (.5963 for 1.5). Seen along a direction the layer's radiance is multiplied by
/// (1 - F)/n^2, as a reflectance factor is that of a perfect diffuser in air.
Surface smooth_surface(double index, Geometry geometry, Specular specular);

/// Reflectance of a rough interface for diffuse light from outside, in [0, 1]: facets of Trowbridge and
/// Reitz's distribution (GGX) of width alpha in [0, 1], Smith's masking of both directions (Walter et al.
/// 2007), light that is reflected once; what is not reflected so is taken to pass. By quadrature, error below
/// 5e-4.
double rough_diffuse_reflectance(double index, double alpha);

/// A rough interface, lit from everywhere. Since it absorbs nothing, 1 - k2 = (1 - k1)/n^2.
Surface rough_surface(double index, double alpha, Specular specular);

/// The reflectance measured of a layer of this inner reflectance, in [0, 1].
double outer_reflectance(const Surface& surface, double inner);

/// The inner reflectance from a measured one. Throws std::domain_error where it is below the interface's own
/// or belongs to a layer that would reflect more than it gets.
double inner_reflectance(const Surface& surface, double outer);

/// A layer with the same interface on both of its sides, in diffuse light:
///     N = (1 - k2 R)^2 - (k2 T)^2,  R' = seen + through (R - k2 (R^2 - T^2))/N,  T' = through T/N.
LayerTransfer outer_transfer(const Surface& surface, LayerTransfer inner);
LayerTransfer inner_transfer(const Surface& surface, LayerTransfer outer);

}  // namespace aureole::pigment
