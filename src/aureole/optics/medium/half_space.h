// SPDX-License-Identifier: Apache-2.0
// Light that a half-space sends back in all, by the theory of radiative transfer: exact for isotropic scattering.
#pragma once

namespace aureole::optics {

/// How light enters: along the normal, or as a uniform sky outside sends it.
enum class Illumination { normal, diffuse };

/// The part of the light that has entered a half-space which leaves it. `albedo` in [0, 1] is that of single
/// scattering, which is isotropic; for others use the reduced albedo. `index`: that of the half-space over that
/// outside; its smooth boundary reflects light back inside by Fresnel's equations. What the boundary reflects
/// outside does not count. Chandrasekhar's H function (Radiative Transfer, 1950, sections 33 and 38) gives the
/// half-space without its boundary; between the two light goes back and forth, a linear system over Gauss nodes.
/// Error below 1e-6. Throws std::domain_error for an albedo or index out of range.
double half_space_reflectance(double albedo, double index, Illumination illumination);

}  // namespace aureole::optics
