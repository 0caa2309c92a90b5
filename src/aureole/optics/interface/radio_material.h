// SPDX-License-Identifier: Apache-2.0
// Building materials at radio frequencies: Recommendation ITU-R P.2040-3 (08/2023), "Effects of building materials and structures
// on radiowave propagation above about 100 MHz", table 3 and equations 28 to 30.
#pragma once

#include <complex>
#include <string>
#include <string_view>
#include <vector>

namespace aureole::optics {

/// Real part of the relative permittivity a f^b and conductivity c f^d in S/m, f in GHz, within a range of frequencies.
struct RadioMaterial {
  std::string_view name;
  double a, b, c, d;
  double min_ghz, max_ghz;
};

/// Returns all rows of the table. A material with two frequency ranges has two rows with the same name.
const std::vector<RadioMaterial>& radio_materials();

/// Returns the relative permittivity eps' + i sigma/(omega eps_0), with time dependence exp(-i omega t). Its
/// square root is the index n + i k. Throws std::domain_error for an unknown name, listing the known ones,
/// and for a frequency outside the material's range, stating that range.
std::complex<double> radio_permittivity(std::string_view material, double frequency_hz);

}  // namespace aureole::optics
