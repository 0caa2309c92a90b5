// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/layer/scatterer_table.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "aureole/optics/arrangement/ring_mean.h"

namespace aureole::optics {
namespace {

constexpr int kRadialEnd = 4096;

int radial_end(const ScattererMixture& mixture, const std::optional<IntensityMap>& map) {
  return mixture.is_isotropic() ? kRadialEnd : int(map->extent());
}

/// Makes a `RadialFunction` of an expensive f in parallel.
RadialFunction radial_function(const std::function<double(double)>& f, int end, bool decays,
                               const ParallelFor& parallel_for) {
  std::vector<double> values = RadialFunction::places(end);
  parallel_for(
      values.size(),
      [&](std::size_t begin, std::size_t stop) {
        for (std::size_t i = begin; i < stop; ++i) values[i] = f(values[i]);
      },
      64);
  return RadialFunction(values, end, decays);
}

/// Returns the ring means of U and C.
std::pair<RadialFunction, RadialFunction> ring_functions(const ScattererMixture& mixture,
                                                         const std::optional<IntensityMap>& map,
                                                         const ParallelFor& parallel_for) {
  const int end = radial_end(mixture, map);
  std::vector<double> uncorrelated = RadialFunction::places(end), coherent(uncorrelated.size());
  const auto mean = [&](double u) -> MixtureIntensity {
    if (mixture.is_isotropic()) return mixture.eval(u, 0);
    u = std::min(u, double(std::nextafter(map->extent(), 0.f)));
    const int points = 24 + int(1.2 * u);
    std::vector<double> x, y, values(2 * std::size_t(points));
    visit_half_ring(u, points, [&](double px, double py) { x.push_back(px), y.push_back(py); });
    map->eval(x, y, values);
    MixtureIntensity sum{};
    for (int i = 0; i < points; ++i) sum.uncorrelated += values[i], sum.coherent += values[points + i];
    return {sum.uncorrelated / points, sum.coherent / points};
  };
  parallel_for(
      uncorrelated.size(),
      [&](std::size_t begin, std::size_t stop) {
        for (std::size_t i = begin; i < stop; ++i) {
          const MixtureIntensity m = mean(uncorrelated[i]);
          uncorrelated[i] = m.uncorrelated, coherent[i] = m.coherent;
        }
      },
      64);
  return {RadialFunction(uncorrelated, end, true), RadialFunction(coherent, end, true)};
}

}  // namespace

ScattererTable::ScattererTable(const ScattererMixture& mixture, double extent,
                               std::shared_ptr<const StructureFactor> anisotropic,
                               const ParallelFor& parallel_for)
    : uncorrelated_([](double) { return 0.0; }, 1, false), coherent_(uncorrelated_) {
  if (!mixture.is_isotropic())
    map_.emplace([&](double x, double y) { return mixture.eval(x, y); }, extent, parallel_for);
  std::tie(uncorrelated_, coherent_) = ring_functions(mixture, map_, parallel_for);
  const double last = map_ ? double(map_->extent())
                           : std::clamp(std::ceil(extent), 80.0, double(IntensityMap::kLargestExtent));
  if (anisotropic) {
    const auto product = [&](double x, double y) {
      const Pair p = eval(float(x), float(y), float(std::hypot(x, y)));
      return double(p.uncorrelated) + double(p.coherent) * anisotropic->eval(x, y);
    };
    product_ =
        radial_function([&](double u) { return ring_mean(u, 128 + int(32 * std::min(u, 32.0)), product); },
                        int(std::ceil(last)), true, parallel_for);
    uncorrelated_azimuths_.emplace(product, last, RingAzimuths::kSpots, parallel_for);
  } else if (map_) {
    // A part that is zero everywhere has no azimuthal distribution: U if all scatterers are equal, C if sizes
    // are correlated or scatterers overlap.
    const auto parts = [&](std::span<const double> x, std::span<const double> y, std::span<double> values) {
      map_->eval(x, y, values);
      if (mixture.is_uniform()) std::fill_n(values.begin(), x.size(), 0.0);
      if (mixture.has_no_coherent_part())
        std::fill(values.begin() + std::ptrdiff_t(x.size()), values.end(), 0.0);
    };
    std::vector<RingAzimuths> both =
        RingAzimuths::of(2, parts, last - 1, RingAzimuths::kShapes, parallel_for);
    uncorrelated_azimuths_ = std::move(both[0]), coherent_azimuths_ = std::move(both[1]);
  }
}

ScattererTable::Pair ScattererTable::envelope(float ux, float uy, float u) const {
  Pair p = ring(u);
  if (coherent_azimuths_) {
    p.uncorrelated *= uncorrelated_azimuths_->density(ux, uy, u);
    p.coherent *= coherent_azimuths_->density(ux, uy, u);
  }
  return p;
}

std::size_t ScattererTable::bytes() const {
  std::size_t sum = uncorrelated_.bytes() + coherent_.bytes();
  if (map_) sum += map_->bytes();
  if (uncorrelated_azimuths_) sum += uncorrelated_azimuths_->bytes();
  if (coherent_azimuths_) sum += coherent_azimuths_->bytes();
  if (product_) sum += product_->bytes();
  return sum;
}

}  // namespace aureole::optics
