// SPDX-License-Identifier: Apache-2.0
// Scattering by objects much smaller than the wavelength: spheres, and molecules of air and water.
#pragma once

#include <complex>
#include <span>

#include "aureole/optics/particle/particle.h"

namespace aureole::optics {

/// Returns the Rayleigh phase function for unpolarised light in 1/sr, with integral 1 over the sphere
/// (Chandrasekhar, Radiative Transfer, 1960, section 18):
///     3/(16 pi) (1 + 3 g + (1 - g) mu^2)/(1 + 2 g),   g = rho/(2 - rho).
/// `rho` in [0, 6/7) is the depolarisation factor of unpolarised light at a right angle.
double rayleigh_phase(double mu, double rho = 0);

/// Returns the King factor (6 + 3 rho)/(6 - 7 rho), the scattering of anisotropic molecules relative to
/// isotropic ones.
double king_factor(double rho);

/// A sphere with size parameter x = 2 pi radius n_medium/lambda << 1: two terms of the series in x (van de
/// Hulst, Light Scattering by Small Particles, 1957, section 6.31; Bohren & Huffman 1983, equations 5.7 and
/// 5.8):
///     Q_sca = 8/3 x^4 |L|^2 (1 + 6/5 x^2 Re (m^2 - 2)/(m^2 + 2)),   L = (m^2 - 1)/(m^2 + 2).
/// A depolarisation factor `rho` multiplies scattering by the King factor and changes the phase function as
/// for molecules; absorption is unchanged.
class RayleighSphere : public Particle {
public:
  /// Makes a sphere. Throws std::domain_error for radius, wavelength or indices that are not positive, and
  /// for rho outside [0, 6/7).
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

/// Returns n - 1 of dry air at 15 C and 1013.25 hPa with 300 ppm CO2, 185 to 1700 nm (Peck & Reeder, J. Opt.
/// Soc. Am. 62 (1972) 958, equation 2).
double air_refractivity(double lambda_nm);
/// Returns the King factor of dry air with 360 ppm CO2, from its gases (Bates, Planet. Space Sci. 32 (1984)
/// 785).
double air_king_factor(double lambda_nm);
/// Returns the scattering cross section of a molecule of air, m^2 (Bodhaine et al., J. Atmos. Oceanic
/// Technol. 16 (1999) 1854). The phase function is `rayleigh_phase` with `air_depolarization`.
double air_cross_section(double lambda_nm);
/// Returns the depolarisation factor that corresponds to `air_king_factor`.
double air_depolarization(double lambda_nm);
/// Number of molecules per m^3 at 15 C and 1013.25 hPa.
inline constexpr double kAirMolecules = 2.546899e25;

/// Returns the scattering coefficient of pure water by density fluctuations, 1/m: 16.06 x 0.93e-4 (550
/// nm/lambda)^4.32 (Morel, "Optical properties of pure water and pure sea water", in Optical Aspects of
/// Oceanography, 1974). The phase function is `rayleigh_phase` with rho = kWaterDepolarization, proportional
/// to 1 + 0.835 mu^2.
double water_scattering(double lambda_nm);
inline constexpr double kWaterDepolarization = 0.09;

}  // namespace aureole::optics
