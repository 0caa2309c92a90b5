// SPDX-License-Identifier: Apache-2.0
// Total reflectance of a half-space by the theory of radiative transfer, exact for isotropic scattering.
#pragma once

namespace aureole::optics {

/// Illumination of the half-space: along the normal, or from a uniform sky outside.
enum class Illumination { normal, diffuse };

/// Returns the fraction of the entered light that leaves the half-space. `albedo` in [0, 1] is the
/// single-scattering albedo for isotropic scattering; for other phase functions use the reduced albedo.
/// `index` is the index of refraction of the half-space over the index outside. Its smooth boundary reflects
/// light back inside by the Fresnel equations; reflection outside does not count. Chandrasekhar's H function
/// (Radiative Transfer, 1950, sections 33 and 38) gives the half-space without its boundary. The
/// interreflection between the two is a linear system over Gauss nodes. The error is below 1e-6. Throws
/// std::domain_error for an albedo or index out of range.
double half_space_reflectance(double albedo, double index, Illumination illumination);

}  // namespace aureole::optics
