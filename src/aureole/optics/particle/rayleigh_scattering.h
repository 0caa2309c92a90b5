// SPDX-License-Identifier: Apache-2.0
// Scattering by what is much smaller than the wavelength: spheres, and molecules of air and water.
#pragma once

#include <complex>
#include <span>

#include "aureole/optics/particle/particle.h"

namespace aureole::optics {

/// Phase function of Rayleigh scattering of unpolarised light in 1/sr (integral 1 over the sphere), for the
/// depolarisation factor `rho` in [0, 6/7) of unpolarised light at a right angle: 3/(16 pi) (1 + 3 g + (1 - g)
/// mu^2)/(1 + 2 g), g = rho/(2 - rho) (Chandrasekhar, Radiative Transfer, 1960, section 18).
double rayleigh_phase(double mu, double rho = 0);

/// King's factor (6 + 3 rho)/(6 - 7 rho), by which anisotropic molecules scatter more than isotropic ones.
double king_factor(double rho);

/// A sphere with x = 2 pi radius n_medium/lambda << 1: two terms of the series in x (van de Hulst, Light
/// Scattering by Small Particles, 1957, section 6.31; Bohren & Huffman 1983, equations 5.7 and 5.8):
///     Q_sca = 8/3 x^4 |L|^2 (1 + 6/5 x^2 Re (m^2 - 2)/(m^2 + 2)),   L = (m^2 - 1)/(m^2 + 2).
/// A depolarisation factor `rho` scales scattering by King's factor and changes the phase function as for
/// molecules; the absorption stays.
class RayleighSphere : public Particle {
public:
  /// Throws std::domain_error for radius, wavelength or indices that are not positive, and rho outside of
  /// [0, 6/7).
  RayleighSphere(double radius, double lambda_nm, std::complex<double> index, double host, double rho = 0);

  using Particle::differential;
  double extinction() const override { return absorption_ + scattering_; }
  double scattering() const override { return scattering_; }
  double geometric() const override { return geometric_; }
  double asymmetry() const override { return 0; }
  void differential(std::span<const double> mu, std::span<double> at,
                    std::span<double> mirrored) const override;

private:
  double scattering_, absorption_, geometric_, rho_;
};

/// n - 1 of dry air at 15 C and 1013.25 hPa with 300 ppm CO2 (Peck & Reeder, J. Opt. Soc. Am. 62 (1972) 958,
/// equation 2), 185 to 1700 nm.
double air_refractivity(double lambda_nm);
/// King's factor of dry air by its gases (Bates, Planet. Space Sci. 32 (1984) 785), with 360 ppm CO2.
double air_king_factor(double lambda_nm);
/// Scattering cross section of a molecule of air, m^2 (Bodhaine et al., J. Atmos. Oceanic Technol. 16 (1999)
/// 1854). Phase function: `rayleigh_phase` with the factor of `air_depolarization`.
double air_cross_section(double lambda_nm);
/// Depolarisation factor that belongs to `air_king_factor`.
double air_depolarization(double lambda_nm);
/// Molecules per m^3 at 15 C and 1013.25 hPa.
inline constexpr double kAirMolecules = 2.546899e25;

/// Scattering coefficient of pure water by its fluctuations, 1/m: 16.06 x 0.93e-4 (550 nm/lambda)^4.32 (Morel,
/// "Optical properties of pure water and pure sea water", in Optical Aspects of Oceanography, 1974). Phase
/// function: `rayleigh_phase` with rho = kWaterDepolarization, proportional to 1 + 0.835 mu^2.
double water_scattering(double lambda_nm);
inline constexpr double kWaterDepolarization = 0.09;

}  // namespace aureole::optics
