// SPDX-License-Identifier: Apache-2.0
// Correlated positions of hard spheres in a fluid: neighbours keep their distance, the scattered waves
// interfere, and a dense suspension scatters less than the sum of its particles.
#pragma once

namespace aureole::optics {

/// Largest volume fraction that the structure factor accepts; hard spheres freeze at 0.494.
inline constexpr double kMaxHardSphereFraction = 0.6;
/// Volume fraction of the closest packing of equal spheres, pi/sqrt(18).
inline constexpr double kClosestSpherePacking = 0.7404804896930610;

/// Returns the structure factor S(q) of hard spheres of radius a and volume `fraction`, by the Percus-Yevick
/// equation (Wertheim 1963; in the form of Kinning & Thomas, Macromolecules 17 (1984) 1712). u = q a; S(0) =
/// (1 - f)^4/(1 + 2 f)^2. Throws std::domain_error for a fraction outside [0, kMaxHardSphereFraction].
double hard_sphere_structure_factor(double u, double fraction);

}  // namespace aureole::optics
