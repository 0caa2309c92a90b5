// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/intensity_map.h"

#include <algorithm>
#include <cmath>

#include "aureole/core/parallel.h"

namespace aureole::optics {

IntensityMap::IntensityMap(const std::function<MixtureIntensity(double, double)>& f, double extent) {
  const double outer = std::clamp(std::ceil(extent) + 1, 80.0, double(kLargestExtent));
  const double extents[] = {8, 16, 32, 64, outer}, rates[] = {20, 16, 12, 5, 2};
  for (int l = 0; l < 5; ++l) {
    Level level{float(extents[l]), float(rates[l]), 0, {}};
    const int half = int(extents[l] * rates[l]);
    level.columns = 2 * half + 4;
    const int rows = half + 4;
    level.nodes.resize(std::size_t(level.columns) * rows);
    const double inner = l > 0 ? extents[l - 1] - 2 / rates[l] : -1;  // what a finer level answers
    for_ranges(
        rows,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t row = begin; row < end; ++row)
            for (int column = 0; column < level.columns; ++column) {
              const double x = (column - half - 1) / rates[l], y = (double(row) - 1) / rates[l];
              if (std::abs(x) < inner && std::abs(y) < inner) continue;
              const MixtureIntensity m = f(x, y);
              level.nodes[row * level.columns + column] = {float(m.uncorrelated), float(m.coherent)};
            }
        },
        4);
    levels_.push_back(std::move(level));
  }
}

std::size_t IntensityMap::bytes() const {
  std::size_t sum = 0;
  for (const Level& l : levels_) sum += l.nodes.size() * sizeof(Pair);
  return sum;
}

IntensityMap::Pair IntensityMap::eval(float ux, float uy) const {
  using Row = float __attribute__((vector_size(32), aligned(4)));  // four nodes
  if (uy < 0) ux = -ux, uy = -uy;
  const float largest = std::max(std::abs(ux), uy);
  const Level* level = levels_.data();
  while (!(largest < level->extent) && level != &levels_.back()) ++level;
  const float x = (ux + level->extent) * level->rate, y = uy * level->rate;
  const int column = int(x), row = int(y);
  const float s = x - float(column), t = y - float(row);
  const auto weights = [](float t, float(&w)[4]) {  // cubic through nodes at -1, 0, 1, 2
    const float a = t * (1 / 6.f), m = t - 1, p = t + 1, q = t - 2;
    w[0] = -a * m * q, w[1] = p * m * q * 0.5f, w[2] = -t * p * q * 0.5f, w[3] = a * p * m;
  };
  float wx[4], wy[4];
  weights(s, wx), weights(t, wy);
  const Pair* node = &level->nodes[std::size_t(row) * level->columns + column];
  Row sum{};
  for (int j = 0; j < 4; ++j) {
    sum += *reinterpret_cast<const Row*>(node) * wy[j];
    node += level->columns;
  }
  const Pair p{sum[0] * wx[0] + sum[2] * wx[1] + sum[4] * wx[2] + sum[6] * wx[3],
               sum[1] * wx[0] + sum[3] * wx[1] + sum[5] * wx[2] + sum[7] * wx[3]};
  // The interpolant swings a little below 0 next to zeros of order two.
  return {std::max(p.uncorrelated, 0.f), std::max(p.coherent, 0.f)};
}

}  // namespace aureole::optics
