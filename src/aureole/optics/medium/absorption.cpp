// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/medium/absorption.h"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace aureole::optics {
namespace {

void require_transmittance(double t) {
  if (!(t > 0 && t <= 1))
    throw std::domain_error("transmittance must be in (0, 1], got " + std::to_string(t));
}
void require_not_negative(double value, const char* name) {
  if (!(value >= 0))
    throw std::domain_error(std::string(name) + " must not be negative, got " + std::to_string(value));
}
void require_positive(double value, const char* name) {
  if (!(value > 0))
    throw std::domain_error(std::string(name) + " must be positive, got " + std::to_string(value));
}

}  // namespace

double transmittance(double absorption, double distance) {
  require_not_negative(absorption, "absorption coefficient");
  require_not_negative(distance, "distance");
  return std::exp(-absorption * distance);
}
double absorptance(double absorption, double distance) {
  require_not_negative(absorption, "absorption coefficient");
  require_not_negative(distance, "distance");
  return -std::expm1(-absorption * distance);
}

double napierian_absorbance(double transmittance) {
  require_transmittance(transmittance);
  return -std::log(transmittance) + 0.0;  // the sum with 0 returns 0, not -0, for T = 1
}
double decadic_absorbance(double transmittance) {
  require_transmittance(transmittance);
  return -std::log10(transmittance) + 0.0;
}
double transmittance_of_napierian(double absorbance) {
  require_not_negative(absorbance, "absorbance");
  return std::exp(-absorbance);
}
double transmittance_of_decadic(double absorbance) {
  require_not_negative(absorbance, "absorbance");
  return std::pow(10.0, -absorbance);
}

double absorption_of_napierian(double absorbance, double distance) {
  require_not_negative(absorbance, "absorbance");
  require_positive(distance, "distance");
  return absorbance / distance;
}
double absorption_of_decadic(double absorbance, double distance) {
  return absorption_of_napierian(std::numbers::ln10 * absorbance, distance);
}

double absorption_of_index(double k, double lambda_nm) {
  require_not_negative(k, "imaginary part of an index");
  require_positive(lambda_nm, "wavelength");
  return 4 * std::numbers::pi * k / (lambda_nm * 1e-9);
}
double index_of_absorption(double absorption, double lambda_nm) {
  require_not_negative(absorption, "absorption coefficient");
  require_positive(lambda_nm, "wavelength");
  return absorption * lambda_nm * 1e-9 / (4 * std::numbers::pi);
}

double absorption_of_molar(double molar, double concentration) {
  require_not_negative(molar, "molar absorption coefficient");
  require_not_negative(concentration, "concentration");
  return std::numbers::ln10 * 100 * molar * concentration;
}
double cross_section_of_molar(double molar) {
  require_not_negative(molar, "molar absorption coefficient");
  return std::numbers::ln10 * 0.1 * molar / kAvogadro;  // the factor 0.1 converts 1 L/(mol cm) to m^2/mol
}
double absorption_of_mass(double specific, double concentration) {
  require_not_negative(specific, "mass-specific absorption coefficient");
  require_not_negative(concentration, "concentration");
  return specific * concentration;
}
double absorption_of_number(double cross_section, double number_density) {
  require_not_negative(cross_section, "absorption cross section");
  require_not_negative(number_density, "number density");
  return cross_section * number_density;
}

double mixture_absorption(std::span<const AbsorbingShare> shares) {
  double sum = 0;
  for (const AbsorbingShare& s : shares) {
    require_not_negative(s.concentration, "concentration");
    require_not_negative(s.coefficient, "absorption coefficient");
    sum += s.concentration * s.coefficient;
  }
  return sum;
}

}  // namespace aureole::optics
