// SPDX-License-Identifier: Apache-2.0
#include "aureole/phase/mie_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace aureole {

namespace {

/// Returns the size parameter 2 pi n r/lambda of the effective radius.
double size_parameter(const optics::RadiusDistribution& radii, double host_index, double nm) {
  return 2 * M_PI * host_index * radii.effective_radius() * 1e9 / nm;
}

/// Returns the number of spectral cells. Features of phase functions move in proportion to the size parameter
/// x. Resonances of spheres of one size repeat over about one unit of x; a spread of sizes blurs them.
/// Rainbows are not blurred: dispersion turns the rainbow of water by some 3 degrees per unit of ln(lambda).
/// It is 120 degrees x^(-2/3) wide (Airy), and nodes must be a fourth of that apart.
double cells_for(const SpectralGrid& grid, const optics::RadiusDistribution& radii, double host_index) {
  constexpr double kSizeStep = 0.25, kRainbow = 4 * 3 / 120.0;
  const double width = std::log(grid.max_nm / grid.min_nm);
  const double x = size_parameter(radii, host_index, grid.min_nm);
  double cells = (x - size_parameter(radii, host_index, grid.max_nm)) / kSizeStep;
  if (const double variance = radii.effective_variance(); variance > 0)
    cells = std::min(cells, 4 * width / std::sqrt(variance));
  return std::max(cells, kRainbow * std::cbrt(x * x) * width);
}

}  // namespace

void require_sizes_for_tables(const SpectralGrid& grid, std::span<const optics::RadiusDistribution> radii,
                              double host_index) {
  constexpr double kMaxSize = 5000;
  for (const optics::RadiusDistribution& r : radii)
    if (const double x = size_parameter(r, host_index, grid.min_nm); x > kMaxSize)
      throw std::domain_error(fmt::format(
          "2 pi n radius/lambda is {:.0f} at the sensor's shortest wavelength, {:.6g} nm; up to {:.0f} is tabulated in a "
          "bearable time",
          x, grid.min_nm, kMaxSize));
}

std::vector<double> mie_wavelengths(const SpectralGrid& grid,
                                    std::span<const optics::RadiusDistribution> radii, double host_index,
                                    double least_per_unit_of_log) {
  constexpr double kMaxCells = 64;
  require_sizes_for_tables(grid, radii, host_index);
  const double least = least_per_unit_of_log * std::log(grid.max_nm / grid.min_nm);
  double cells = least;
  for (const optics::RadiusDistribution& r : radii) cells = std::max(cells, cells_for(grid, r, host_index));
  const int nodes = int(std::ceil(std::min(cells, std::max(kMaxCells, least)))) + 1;
  const double range = 1 / grid.min_nm - 1 / grid.max_nm;
  std::vector<double> nm;
  for (int i = 0; i < nodes; ++i) nm.push_back(1 / (1 / grid.min_nm - range * i / (nodes - 1)));
  return nm;
}

optics::EnsembleAccuracy mie_accuracy(std::span<const optics::RadiusDistribution> radii, double host_index,
                                      double nm) {
  double x = 1;
  for (const optics::RadiusDistribution& r : radii) x = std::max(x, size_parameter(r, host_index, nm));
  optics::EnsembleAccuracy a;
  a.averaging = 5e-3, a.phase_averaging = 3e-2;
  // The cost grows as the square of the size, times the number of radii.
  a.most_radii = std::size_t(std::clamp(3e5 / x, 128.0, 1024.0));
  a.phase.relative = 1e-2, a.phase.floor = 1e-3;
  a.phase.most_nodes = 12000;
  return a;
}

}  // namespace aureole
