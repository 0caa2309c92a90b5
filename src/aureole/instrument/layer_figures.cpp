// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/layer_figures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "aureole/core/error.h"
#include "aureole/core/parallel.h"
#include "aureole/instrument/wavelength_steps.h"
#include "aureole/spectrum/observer.h"
#include "aureole/spectrum/tables.h"

namespace aureole {

namespace {

/// X, Y, Z of the illuminant times a spectral fraction, relative to the illuminant's Y.
std::array<double, 3> tristimulus_of_layer(const std::vector<LightBudget>& rows, const SampledSpectrum& lamp,
                                           const SpectralGrid& grid, double (*fraction)(const LightBudget&)) {
  const auto xyz = observer_xyz(grid);
  std::array<double, 3> sum{};
  double white = 0;
  for (int i = 0; i <= grid.cells; ++i) {
    const double nm = grid.node(i), light = double(lamp.nodes()[std::size_t(i)]);
    const double x = std::clamp((nm - rows.front().nm) / std::max(rows[1].nm - rows[0].nm, 1e-9), 0.0,
                                double(rows.size() - 1));
    const std::size_t k = std::min(std::size_t(x), rows.size() - 2);
    const double f = std::lerp(fraction(rows[k]), fraction(rows[k + 1]), x - double(k));
    for (std::size_t c = 0; c < 3; ++c) sum[c] += light * f * double(xyz[c].nodes()[std::size_t(i)]);
    white += light * double(xyz[1].nodes()[std::size_t(i)]);
  }
  for (double& c : sum) c /= white;
  return sum;
}

std::size_t quantity_index(std::string_view key) {
  return std::size_t(std::find_if(kLayerQuantities.begin(), kLayerQuantities.end(),
                                  [&](const LayerQuantity& q) { return q.key == key; }) -
                     kLayerQuantities.begin());
}

}  // namespace

double LayerFigures::haze() const {
  if (xyz.empty()) return std::numeric_limits<double>::quiet_NaN();
  const double total = xyz[quantity_index("total_transmission")][1];
  return total > 0 ? xyz[quantity_index("diffuse_transmission_far")][1] / total
                   : std::numeric_limits<double>::quiet_NaN();
}

LayerFigures measure_layer(const Bsdf& bsdf, const SpectralGrid& grid, const LayerSettings& settings) {
  const auto table = find_illuminant(settings.illuminant);
  if (!table)
    throw Error("--illuminant: unknown illuminant \"" + settings.illuminant + "\"" +
                did_you_mean(settings.illuminant, illuminant_names()));
  const SampledSpectrum lamp = SampledSpectrum::from_points(grid, table->wavelengths_nm, table->values);
  const double theta = settings.angle_degrees * M_PI / 180, phi = settings.azimuth_degrees * M_PI / 180;
  const Vec3 wi{float(std::sin(theta) * std::cos(phi)), float(std::sin(theta) * std::sin(phi)),
                float(std::cos(theta))};
  LayerFigures figures;
  std::vector<LightBudget>& rows = figures.rows;
  for (const double nm : wavelength_steps(grid, settings.step_nm, 20)) rows.emplace_back().nm = nm;
  for_ranges(
      rows.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
          rows[i] = measure_light_budget(bsdf, wi, rows[i].nm, grid, settings.budget);
      },
      1);
  const bool is_visible = rows.size() > 1 && tristimulus_of_layer(rows, lamp, grid, [](const LightBudget&) {
                                               return 1.0;
                                             })[1] > 0;
  if (is_visible)
    for (const LayerQuantity& q : kLayerQuantities)
      figures.xyz.push_back(tristimulus_of_layer(rows, lamp, grid, q.of));
  return figures;
}

}  // namespace aureole
