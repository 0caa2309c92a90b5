// SPDX-License-Identifier: Apache-2.0
// The interface between a paint's binder and air, for diffuse light: J. L. Saunderson, Calculation of the
// color of pigmented plastics, J. Opt. Soc. Am. 32, 1942. "Inner" quantities are for the pigmented layer
// within the binder, "outer" ones are as measured by an instrument.
#pragma once

#include <string_view>

#include "aureole/pigment/kubelka_munk_layer.h"

namespace aureole::pigment {

/// Interface coefficients: R_outer = seen + through R/(1 - k2 R). The default is no interface.
struct Surface {
  double seen = 0;     ///< light reflected by the interface itself, as measured by the instrument
  double through = 1;  ///< transmission of the interface in and out; (1 - k1)(1 - k2) in Saunderson's form
  double k2 = 0;       ///< reflectance of the interface for diffuse light from inside
};

/// Whether specular reflection is included ("SCI") or excluded ("SCE").
enum class Specular { included, excluded };

/// Saunderson's own form: k1 is the reflectance of the interface from outside, as measured by the instrument,
/// k2 from inside; both are in [0, 1).
Surface saunderson_surface(double k1, double k2, Specular specular);

/// Illumination and measurement geometry of an instrument.
enum class Geometry {
  diffuse_diffuse,  ///< diffuse illumination, all reflected light measured: k1 is 0.0918 for an index of 1.5
  diffuse_8,  ///< illuminated by a sphere, measured at 8 degrees (d:8, or 8:d): k1 is the Fresnel reflectance
              ///< at 8 degrees
  angle_45_0  ///< illuminated at 45 degrees, measured along the normal: never any specular light
};
/// Returns the geometry called "diffuse", "d8" or "45_0".
Geometry geometry_called(std::string_view name);
/// Returns the name "diffuse", "d8" or "45_0".
std::string_view name_of(Geometry geometry);
/// Returns the name "included" or "excluded".
std::string_view name_of(Specular specular);

/// A smooth interface to a binder of relative index n >= 1. k2 is the integral of the Fresnel reflectance for
/// diffuse light from inside (0.5963 for 1.5). For measurement along a direction, the layer's radiance is
/// multiplied by (1 - F)/n^2, as a reflectance factor is relative to a perfect diffuser in air.
Surface smooth_surface(double index, Geometry geometry, Specular specular);

/// Reflectance of a rough interface for diffuse light from outside, in [0, 1]. The model has facets of
/// Trowbridge and Reitz's distribution (GGX) of width alpha in [0, 1], Smith's masking of both directions
/// (Walter et al. 2007), and single reflection; all other light is assumed to be transmitted. By quadrature,
/// error below 5e-4.
double rough_diffuse_reflectance(double index, double alpha);

/// A rough interface under diffuse illumination. As it absorbs nothing, 1 - k2 = (1 - k1)/n^2.
Surface rough_surface(double index, double alpha, Specular specular);

/// The measured reflectance of a layer of this inner reflectance, in [0, 1].
double outer_reflectance(const Surface& surface, double inner);

/// The inner reflectance for a measured one. Throws std::domain_error if it is below the interface's own
/// reflectance or implies an inner reflectance above one.
double inner_reflectance(const Surface& surface, double outer);

/// The reflectance that an instrument of geometry `to` would measure of a layer that an instrument of
/// geometry `from` has measured: `outer_reflectance(to, inner_reflectance(from, outer))`, for a smooth binder
/// of one index. With k1 of the binder it adds or removes gloss (specular component included or excluded).
double converted_reflectance(const Surface& from, const Surface& to, double outer);

/// Reflectance and transmittance of a layer with equal interfaces on both sides, in diffuse light:
///     N = (1 - k2 R)^2 - (k2 T)^2,  R' = seen + through (R - k2 (R^2 - T^2))/N,  T' = through T/N.
LayerTransfer outer_transfer(const Surface& surface, LayerTransfer inner);
LayerTransfer inner_transfer(const Surface& surface, LayerTransfer outer);

}  // namespace aureole::pigment
