// SPDX-License-Identifier: Apache-2.0
// `IntensityMap`: U(u) and C(u) of a mixture that is not isotropic, tabulated over the plane for look-up in
// single precision.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "aureole/optics/scatterer_mixture.h"

namespace aureole::optics {

/// Nested grids, finer towards the centre: steps of 1/20 up to |ux|, |uy| = 8, 1/16 up to 16, 1/12 up to 32,
/// 1/5 up to 64 and 1/2 beyond, between which a point takes the bicubic interpolant (four-point Lagrange).
/// Transforms of a shape within a circle of radius 1 have no frequency above 2 and fall as 1/u or faster: the
/// error stays below 1e-5 of the peak (the tests measure it).
class IntensityMap {
public:
  struct Pair {
    float uncorrelated, coherent;
  };
  static constexpr int kLargestExtent = 240;

  /// `extent`: up to where |u| is wanted; at most kLargestExtent is tabulated. `f` is called from several
  /// threads.
  IntensityMap(const std::function<MixtureIntensity(double, double)>& f, double extent);

  /// |ux| and |uy| where the map ends. Beyond it `eval` must not be called.
  float extent() const { return extents_[kLevels - 1]; }
  Pair eval(float ux, float uy) const {
    Pair p;
    eval<1>(&ux, &uy, &p.uncorrelated, &p.coherent);
    return p;
  }
  /// Of N points at once: places and weights of all of them are computed together. Points beyond the map give
  /// numbers without meaning.
  template <int N>
  void eval(const float* ux, const float* uy, float* uncorrelated, float* coherent) const;
  std::size_t bytes() const { return nodes_.size() * sizeof(Pair); }

private:
  static constexpr int kLevels = 5;
  float extents_[kLevels], rates_[kLevels];  // rate: nodes per unit
  std::int32_t columns_[kLevels], first_[kLevels];
  /// Nodes (U, C), level by level, for ux from -extent - step and uy from -step: the lower half plane is the
  /// upper one turned by 180 degrees.
  std::vector<Pair> nodes_;
};

template <int N>
void IntensityMap::eval(const float* ux, const float* uy, float* uncorrelated, float* coherent) const {
  using Row = float __attribute__((vector_size(32), aligned(4)));  // four nodes
  std::int32_t node[N], stride[N];
  float wx[4][N], wy[4][N];
  for (int j = 0; j < N; ++j) {
    const float x0 = uy[j] < 0 ? -ux[j] : ux[j], y0 = uy[j] < 0 ? -uy[j] : uy[j];
    const float ax = x0 < 0 ? -x0 : x0;
    const float largest = ax > y0 ? ax : y0, last = extents_[kLevels - 1];
    float extent = last, rate = rates_[kLevels - 1];
    std::int32_t first = first_[kLevels - 1], columns = columns_[kLevels - 1];
    for (int l = kLevels - 2; l >= 0; --l) {
      const bool inside = largest < extents_[l];
      extent = inside ? extents_[l] : extent, rate = inside ? rates_[l] : rate;
      first = inside ? first_[l] : first, columns = inside ? columns_[l] : columns;
    }
    const bool on_map = largest < last;
    const float x = ((on_map ? x0 : 0) + extent) * rate, y = (on_map ? y0 : 0) * rate;
    const std::int32_t column = std::int32_t(x), row = std::int32_t(y);
    node[j] = first + row * columns + column;
    stride[j] = columns;
    // The cubics through nodes at -1, 0, 1, 2.
    const auto weights = [j](float t, float(&w)[4][N]) {
      const float a = t * (1 / 6.f), m = t - 1, p = t + 1, q = t - 2;
      w[0][j] = -a * m * q, w[1][j] = p * m * q * 0.5f, w[2][j] = -t * p * q * 0.5f, w[3][j] = a * p * m;
    };
    weights(x - float(column), wx);
    weights(y - float(row), wy);
  }
  for (int j = 0; j < N; ++j) {
    const Pair* p = &nodes_[std::size_t(node[j])];
    Row sum = *reinterpret_cast<const Row*>(p) * wy[0][j];
    for (int i = 1; i < 4; ++i) {
      p += stride[j];
      sum += *reinterpret_cast<const Row*>(p) * wy[i][j];
    }
    const float u = sum[0] * wx[0][j] + sum[2] * wx[1][j] + sum[4] * wx[2][j] + sum[6] * wx[3][j];
    const float c = sum[1] * wx[0][j] + sum[3] * wx[1][j] + sum[5] * wx[2][j] + sum[7] * wx[3][j];
    // The interpolant swings a little below 0 next to zeros of order two.
    uncorrelated[j] = u > 0 ? u : 0, coherent[j] = c > 0 ? c : 0;
  }
}

}  // namespace aureole::optics
