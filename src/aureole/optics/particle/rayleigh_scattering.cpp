// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/particle/rayleigh_scattering.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "aureole/optics/constants.h"

namespace aureole::optics {
namespace {

void check_depolarization(double rho) {
  if (!(rho >= 0 && rho < 6.0 / 7))
    throw std::domain_error("depolarisation factor must be in [0, 6/7), got " + std::to_string(rho));
}

}  // namespace

double rayleigh_phase(double mu, double rho) {
  check_depolarization(rho);
  const double g = rho / (2 - rho);
  return 3 / (16 * kPi) * (1 + 3 * g + (1 - g) * mu * mu) / (1 + 2 * g);
}

double king_factor(double rho) {
  check_depolarization(rho);
  return (6 + 3 * rho) / (6 - 7 * rho);
}

RayleighSphere::RayleighSphere(double radius, double lambda_nm, std::complex<double> index, double host,
                               double rho)
    : geometric_(kPi * radius * radius), rho_(rho) {
  if (!(radius > 0 && lambda_nm > 0 && host > 0 && index.real() > 0 && index.imag() >= 0))
    throw std::domain_error("radius, wavelength and indices of a small sphere must be positive, got " +
                            std::to_string(radius) + " m, " + std::to_string(lambda_nm) + " nm, " +
                            std::to_string(index.real()) + " + " + std::to_string(index.imag()) + "i in " +
                            std::to_string(host));
  const double factor = king_factor(rho);
  const double x = 2 * kPi * radius * host / (lambda_nm * 1e-9);
  const std::complex<double> m2 = (index / host) * (index / host);
  const std::complex<double> l = (m2 - 1.0) / (m2 + 2.0);
  const std::complex<double> second = x * x / 15 * l * (m2 * m2 + 27.0 * m2 + 38.0) / (2.0 * m2 + 3.0);
  const double sixth = 1.2 * ((m2 - 2.0) / (m2 + 2.0)).real() * x * x;
  scattering_ = geometric_ * factor * 8 / 3 * std::pow(x, 4) * std::norm(l) * std::max(0.0, 1 + sixth);
  // The last term is radiation damping of the sphere's dipole.
  const double radiated = 16.0 / 3 * std::pow(x, 4) * l.imag() * l.imag();
  absorption_ = geometric_ * std::max(0.0, 4 * x * (l * (1.0 + second)).imag() - radiated);
}

void RayleighSphere::differential(std::span<const double> mu, std::span<double> at,
                                  std::span<double> mirrored) const {
  for (std::size_t i = 0; i < mu.size(); ++i) {
    at[i] = scattering_ * rayleigh_phase(mu[i], rho_);
    if (!mirrored.empty()) mirrored[i] = at[i];
  }
}

double air_refractivity(double lambda_nm) {
  const double s2 = 1e6 / (lambda_nm * lambda_nm);  // squared wavenumber [1/um^2]
  return 1e-8 * (8060.51 + 2480990 / (132.274 - s2) + 17455.7 / (39.32957 - s2));
}

double air_king_factor(double lambda_nm) {
  const double s2 = 1e6 / (lambda_nm * lambda_nm);
  const double nitrogen = 1.034 + 3.17e-4 * s2, oxygen = 1.096 + 1.385e-3 * s2 + 1.448e-4 * s2 * s2;
  constexpr double kArgon = 1.00, kCarbonDioxide = 1.15;
  return (78.084 * nitrogen + 20.946 * oxygen + 0.934 * kArgon + 0.036 * kCarbonDioxide) /
         (78.084 + 20.946 + 0.934 + 0.036);
}

double air_cross_section(double lambda_nm) {
  const double n = 1 + air_refractivity(lambda_nm), lambda = lambda_nm * 1e-9;
  const double l = (n * n - 1) / (n * n + 2);
  return 24 * std::pow(kPi, 3) * l * l / (std::pow(lambda, 4) * kAirMolecules * kAirMolecules) *
         air_king_factor(lambda_nm);
}

double air_depolarization(double lambda_nm) {
  const double f = air_king_factor(lambda_nm);
  return 6 * (f - 1) / (7 * f + 3);
}

double water_scattering(double lambda_nm) { return 16.06 * 0.93e-4 * std::pow(550 / lambda_nm, 4.32); }

}  // namespace aureole::optics
