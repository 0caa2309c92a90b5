// SPDX-License-Identifier: Apache-2.0
// Light that leaves a half-space after it has been scattered once, where a thin beam enters it along the normal.
#pragma once

#include <array>

namespace aureole::optics {

/// The power per area at the distance r is sigma_s sigma_t f(sigma_t r) of the power that has entered. A beam that is
/// scattered at the depth t towards the surface at the angle theta from the normal leaves at r = t tan(theta) after the
/// way t + t/cos(theta); with the angle in place of t (Habel, Christensen & Jarosz 2013, "Photon beam diffusion", section
/// 4.3, written so)
///     f(x) = 1/x integral of exp(-x cot(theta/2)) p(-cos theta) cos theta (1 - F(theta)) over theta,
/// p the phase function and F the Fresnel reflectance from inside. By Gauss nodes 2 pi x f(x) is a sum of exponentials
/// in x, weights[k] exp(-rates[k] x), whose integral and inverse are closed forms.
struct SingleScattering {
  static constexpr int kNodes = 12;
  std::array<double, kNodes> weights{}, rates{};

  /// Of Henyey & Greenstein's phase function with asymmetry g in (-1, 1); `index` is that of the half-space over that
  /// outside. Throws std::domain_error where either is out of its range.
  SingleScattering(double g, double index);

  double profile(double x) const;  ///< f
  /// The part of the light that has entered which leaves, over the single-scattering albedo.
  double total() const;
};

}  // namespace aureole::optics
