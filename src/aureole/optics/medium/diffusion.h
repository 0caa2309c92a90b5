// SPDX-License-Identifier: Apache-2.0
// Coefficients of a medium in the diffusion approximation, for light that has been scattered many times
// (Ishimaru, Wave Propagation and Scattering in Random Media, 1978, chapter 9).
#pragma once

namespace aureole::optics {

/// Coefficients in 1/m, lengths in m.
struct DiffusionCoefficients {
  double reduced_scattering = 0;  ///< sigma_s' = sigma_s (1 - g)
  double transport = 0;           ///< sigma_tr = sigma_a + sigma_s'
  double reduced_albedo = 1;      ///< sigma_s'/sigma_tr; 1 where that quotient is 0/0
  /// Diffusion coefficient D = 1/(3 sigma_tr), m: the flux is -D times the gradient of the fluence. Infinite
  /// without a medium.
  double diffusion = 0;
  /// effective attenuation coefficient sqrt(3 sigma_a sigma_tr): fluence falls as exp(-effective r)/r
  double effective = 0;
  double mean_free_path = 0;    ///< 1/(sigma_a + sigma_s)
  double transport_length = 0;  ///< 1/sigma_tr
};

/// Returns the coefficients. Throws std::domain_error for a negative coefficient or g outside [-1, 1].
DiffusionCoefficients diffusion_coefficients(double absorption, double scattering, double asymmetry);

/// Returns the fluence (W/m^2) at `distance` m from an isotropic point source of 1 W in an infinite medium:
/// exp(-effective r)/(4 pi D r).
double diffusion_fluence(const DiffusionCoefficients& medium, double distance);

}  // namespace aureole::optics
