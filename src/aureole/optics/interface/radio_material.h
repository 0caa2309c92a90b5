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

/// All rows of the table; of a material with two ranges two rows of one name.
const std::vector<RadioMaterial>& radio_materials();

/// Relative permittivity eps' + i sigma/(omega eps_0), time dependence exp(-i omega t); its root is the index n + i k. Throws
/// std::domain_error for a name that is not in the table, with the names, and for a frequency outside of a material's limits, with these.
std::complex<double> radio_permittivity(std::string_view material, double frequency_hz);

}  // namespace aureole::optics
