// SPDX-License-Identifier: Apache-2.0
#include "aureole/parameter/radio_index.h"

#include <algorithm>
#include <stdexcept>

#include "aureole/optics/interface/radio_material.h"

namespace aureole {

namespace {

constexpr std::string_view kPrefix = "itu_";

double frequency_hz(double nm) { return 299792458.0 / (nm * 1e-9); }

}  // namespace

std::vector<std::string> radio_material_names() {
  std::vector<std::string> names;
  for (const optics::RadioMaterial& m : optics::radio_materials()) {
    std::string name = std::string(kPrefix) + std::string(m.name);
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(std::move(name));
  }
  return names;
}

std::optional<std::function<std::complex<double>(double)>> radio_index(const Properties& properties,
                                                                       std::string_view name,
                                                                       const std::string& material) {
  if (!material.starts_with(kPrefix)) return {};
  const auto names = radio_material_names();
  if (std::find(names.begin(), names.end(), material) == names.end())
    throw properties.error(name,
                           "unknown material \"" + material + "\"" + did_you_mean_or_all(material, names));
  const std::string row = material.substr(kPrefix.size());
  const SpectralGrid& grid = properties.context().grid;
  try {
    for (int i = 0; i <= grid.cells; ++i) optics::radio_permittivity(row, frequency_hz(grid.node(i)));
  } catch (const std::domain_error& e) {
    throw properties.error(
        name,
        std::string(e.what()) + "; the film's wavelength_min and wavelength_max say what the sensor sees");
  }
  return [row, least = grid.min_nm, most = grid.max_nm](double nm) {
    return std::sqrt(optics::radio_permittivity(row, frequency_hz(std::clamp(nm, least, most))));
  };
}

}  // namespace aureole
