// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/medium/diffusion.h"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace aureole::optics {

DiffusionCoefficients diffusion_coefficients(double absorption, double scattering, double asymmetry) {
  if (!(absorption >= 0 && scattering >= 0))
    throw std::domain_error("absorption and scattering coefficients must not be negative, got " +
                            std::to_string(absorption) + " and " + std::to_string(scattering) + " /m");
  if (!(asymmetry >= -1 && asymmetry <= 1))
    throw std::domain_error("asymmetry must be in [-1, 1], got " + std::to_string(asymmetry));
  DiffusionCoefficients d;
  d.reduced_scattering = scattering * (1 - asymmetry);
  d.transport = absorption + d.reduced_scattering;
  if (d.transport > 0) d.reduced_albedo = d.reduced_scattering / d.transport;
  d.diffusion = 1 / (3 * d.transport);
  d.effective = std::sqrt(3 * absorption * d.transport);
  d.mean_free_path = 1 / (absorption + scattering);
  d.transport_length = 1 / d.transport;
  return d;
}

double diffusion_fluence(const DiffusionCoefficients& medium, double distance) {
  if (!(distance > 0)) throw std::domain_error("distance must be positive, got " + std::to_string(distance));
  return std::exp(-medium.effective * distance) / (4 * std::numbers::pi * medium.diffusion * distance);
}

}  // namespace aureole::optics
