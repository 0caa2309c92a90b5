// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/layer/scatterer_table.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "aureole/optics/arrangement/ring_mean.h"

namespace aureole::optics {
namespace {

constexpr int kRadialEnd = 4096;

int radial_end(const ScattererMixture& mixture, const std::optional<IntensityMap>& map) {
  return mixture.is_isotropic() ? kRadialEnd : int(map->extent());
}

/// `RadialFunction` of an expensive f.
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

RadialFunction ring_function(const ScattererMixture& mixture, const std::optional<IntensityMap>& map,
                             bool coherent, const ParallelFor& parallel_for) {
  const auto part = [coherent](const auto& m) { return double(coherent ? m.coherent : m.uncorrelated); };
  return radial_function(
      [&](double u) {
        if (mixture.is_isotropic()) return part(mixture.eval(u, 0));
        u = std::min(u, double(std::nextafter(map->extent(), 0.f)));
        return ring_mean(u, 24 + int(1.2 * u),
                         [&](double x, double y) { return part(map->eval(float(x), float(y))); });
      },
      radial_end(mixture, map), true, parallel_for);
}

}  // namespace

ScattererTable::ScattererTable(const ScattererMixture& mixture, double extent,
                               std::shared_ptr<const StructureFactor> anisotropic,
                               const ParallelFor& parallel_for)
    : uncorrelated_([](double) { return 0.0; }, 1, false), coherent_(uncorrelated_) {
  if (!mixture.is_isotropic())
    map_.emplace([&](double x, double y) { return mixture.eval(x, y); }, extent, parallel_for);
  uncorrelated_ = ring_function(mixture, map_, false, parallel_for);
  coherent_ = ring_function(mixture, map_, true, parallel_for);
  const auto at = [this](double x, double y) { return eval(float(x), float(y), float(std::hypot(x, y))); };
  const double last = map_ ? double(map_->extent())
                           : std::clamp(std::ceil(extent), 80.0, double(IntensityMap::kLargestExtent));
  if (anisotropic) {
    const auto product = [&](double x, double y) {
      const Pair p = at(x, y);
      return double(p.uncorrelated) + double(p.coherent) * anisotropic->eval(x, y);
    };
    product_ =
        radial_function([&](double u) { return ring_mean(u, 128 + int(32 * std::min(u, 32.0)), product); },
                        int(std::ceil(last)), true, parallel_for);
    uncorrelated_azimuths_.emplace(product, last, RingAzimuths::kSpots, parallel_for);
  } else if (map_) {
    // A part that is zero everywhere has no azimuths to look for: U where all scatterers are alike, C where
    // sizes are correlated.
    using Part = std::function<double(double, double)>;
    const Part zero = [](double, double) { return 0.0; };
    const Part uncorrelated = [&](double x, double y) { return double(at(x, y).uncorrelated); };
    const Part coherent = [&](double x, double y) { return double(at(x, y).coherent); };
    uncorrelated_azimuths_.emplace(mixture.is_uniform() ? zero : uncorrelated, last - 1,
                                   RingAzimuths::kShapes, parallel_for);
    coherent_azimuths_.emplace(mixture.has_correlated_sizes() ? zero : coherent, last - 1,
                               RingAzimuths::kShapes, parallel_for);
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
