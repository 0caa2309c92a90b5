// SPDX-License-Identifier: Apache-2.0
// Light that leaves a half-space after a single scattering, for a thin beam that enters it along the normal.
#pragma once

#include <array>

namespace aureole::optics {

/// The power per area at the distance r is sigma_s sigma_t f(sigma_t r) of the entered power. A beam that is
/// scattered at the depth t by the angle theta from the normal leaves at r = t tan(theta), after the path
/// length t + t/cos(theta). With the angle as the variable (after Habel, Christensen & Jarosz 2013, "Photon
/// beam diffusion", section 4.3)
///     f(x) = 1/x integral of exp(-x cot(theta/2)) p(-cos theta) cos theta (1 - F(theta)) over theta,
/// with p the phase function and F the Fresnel reflectance from inside. By Gauss nodes 2 pi x f(x) is a sum
/// of exponentials in x, weights[k] exp(-rates[k] x), whose integral and inverse have closed forms.
struct SingleScattering {
  static constexpr int kNodes = 12;
  std::array<double, kNodes> weights{}, rates{};

  /// Computes the sum for a Henyey-Greenstein phase function with asymmetry g in (-1, 1); `index` is the
  /// index of refraction of the half-space over the index outside. Throws std::domain_error if either is out
  /// of range.
  SingleScattering(double g, double index);

  double profile(double x) const;  ///< f
  /// Returns the fraction of the entered light that leaves after one scattering, over the single-scattering
  /// albedo.
  double total() const;
};

}  // namespace aureole::optics
