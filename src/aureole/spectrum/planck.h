// SPDX-License-Identifier: Apache-2.0
// Planck's law: the spectral radiance of a black body in vacuum (M. Planck, Annalen der Physik 309, 1901),
//     L = 2 h c^2 / (lambda^5 (exp(h c / (lambda k T)) - 1)),  in W / (m^2 sr nm).
#pragma once

#include <cmath>

#include "aureole/spectrum/spectrum.h"

namespace aureole {

/// Returns the spectral radiance [W/(m^2 sr nm)] at a vacuum wavelength [nm] and a temperature [K], both
/// positive.
inline double black_body_radiance(double nm, double kelvin) {
  // Constants that are exact by the definition of the SI units (2019): Planck constant, speed of light,
  // Boltzmann constant.
  constexpr double kPlanck = 6.62607015e-34, kSpeedOfLight = 299792458, kBoltzmann = 1.380649e-23;
  const double metres = nm * 1e-9;
  return 1e-9 * 2 * kPlanck * kSpeedOfLight * kSpeedOfLight /
         (std::pow(metres, 5) * std::expm1(kPlanck * kSpeedOfLight / (metres * kBoltzmann * kelvin)));
}
/// Returns the spectral radiance at the wavelengths of a path; zero at and below 0 K.
inline Spectrum black_body_radiance(const Spectrum& nm, float kelvin) {
  if (!(kelvin > 0)) return 0.f;
  return make_spectrum([&](int i) { return float(black_body_radiance(double(nm[i]), double(kelvin))); });
}

}  // namespace aureole
