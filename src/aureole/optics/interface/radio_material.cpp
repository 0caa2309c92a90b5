// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/interface/radio_material.h"

#include <cmath>
#include <cstdio>
#include <numbers>
#include <stdexcept>

namespace aureole::optics {
namespace {

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

}  // namespace

const std::vector<RadioMaterial>& radio_materials() {
  static const std::vector<RadioMaterial> table = {
      {"vacuum", 1, 0, 0, 0, 0.001, 100},
      {"concrete", 5.24, 0, 0.0462, 0.7822, 1, 100},
      {"brick", 3.91, 0, 0.0238, 0.16, 1, 40},
      {"plasterboard", 2.73, 0, 0.0085, 0.9395, 1, 100},
      {"wood", 1.99, 0, 0.0047, 1.0718, 0.001, 100},
      {"glass", 6.31, 0, 0.0036, 1.3394, 0.1, 100},
      {"glass", 5.79, 0, 0.0004, 1.658, 220, 450},
      {"ceiling_board", 1.48, 0, 0.0011, 1.075, 1, 100},
      {"ceiling_board", 1.52, 0, 0.0029, 1.029, 220, 450},
      {"chipboard", 2.58, 0, 0.0217, 0.78, 1, 100},
      {"plywood", 2.71, 0, 0.33, 0, 1, 40},
      {"marble", 7.074, 0, 0.0055, 0.9262, 1, 60},
      {"floorboard", 3.66, 0, 0.0044, 1.3515, 50, 100},
      {"metal", 1, 0, 1e7, 0, 1, 100},
      {"very_dry_ground", 3, 0, 0.00015, 2.52, 1, 10},
      {"medium_dry_ground", 15, -0.1, 0.035, 1.63, 1, 10},
      {"wet_ground", 30, -0.4, 0.15, 1.3, 1, 10},
  };
  return table;
}

std::complex<double> radio_permittivity(std::string_view material, double frequency_hz) {
  const double ghz = frequency_hz * 1e-9;
  std::string limits, names;
  for (const RadioMaterial& m : radio_materials()) {
    if (m.name == material) {
      if (ghz >= m.min_ghz && ghz <= m.max_ghz) {
        constexpr double kVacuum = 8.8541878128e-12;  // vacuum permittivity [F/m], CODATA 2018
        const double conductivity = m.c * std::pow(ghz, m.d);
        return {m.a * std::pow(ghz, m.b), conductivity / (2 * std::numbers::pi * frequency_hz * kVacuum)};
      }
      limits += (limits.empty() ? "" : " and ") + number(m.min_ghz) + " to " + number(m.max_ghz) + " GHz";
    }
    if (names.empty() || !names.ends_with(m.name)) names += (names.empty() ? "" : ", ") + std::string(m.name);
  }
  if (limits.empty())
    throw std::domain_error("material: expected one of " + names + ", got '" + std::string(material) + "'");
  throw std::domain_error("frequency: the permittivity of " + std::string(material) + " is known for " +
                          limits + ", got " + number(ghz) + " GHz");
}

}  // namespace aureole::optics
