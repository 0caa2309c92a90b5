// SPDX-License-Identifier: Apache-2.0
#include "aureole/parameter/data_range.h"

#include <fmt/format.h>

#include <algorithm>

namespace aureole {

std::string range_text(double min_nm, double max_nm) {
  return fmt::format("{:.6g} to {:.6g} nm", min_nm, max_nm);
}

void note_data_range(const Properties& properties, std::string_view name, const std::string& subject,
                     const WavelengthRange& data) {
  const SpectralGrid& grid = properties.context().grid;
  // Tolerance for the rounding of wavelengths that are given as frequencies.
  const double tolerance = 1e-9 * grid.max_nm;
  std::string outside;
  if (grid.min_nm < data.min_nm - tolerance)
    outside = range_text(grid.min_nm, std::min(data.min_nm, grid.max_nm));
  if (grid.max_nm > data.max_nm + tolerance)
    outside += (outside.empty() ? "" : " and ") + range_text(std::max(data.max_nm, grid.min_nm), grid.max_nm);
  if (outside.empty()) return;
  const std::string where = properties.has(name) ? "parameter \"" + std::string(name) + "\": " : "";
  properties.note(name, where + subject + " is known from " + range_text(data.min_nm, data.max_nm) +
                            "; at the other wavelengths of the film, " + outside +
                            ", the value at the nearer end is used");
}

}  // namespace aureole
