// SPDX-License-Identifier: Apache-2.0
// `IntensityMap`: the two parts U(u) and C(u) of the intensity of an anisotropic mixture
// (scatterer_mixture.h), tabulated over the plane for look-up in single precision.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <span>
#include <vector>

#include "aureole/core/parallel_for.h"
#include "aureole/optics/layer/scatterer_mixture.h"

namespace aureole::optics {

/// Nested grids, finer towards the centre: steps of 1/20 up to |ux|, |uy| = 8, 1/16 up to 16, 1/12 up to 32,
/// 1/5 up to 64 and 1/2 beyond. Interpolation is bicubic (four-point Lagrange). Transforms of a shape within
/// a circle of radius 1 have no frequency above 2 and fall at least as 1/u, so the error stays below 1e-5 of
/// the peak (the tests measure it).
class IntensityMap {
public:
  struct Pair {
    float uncorrelated, coherent;
    template <class Self, class Fields>
    static void fields(Self& self, Fields& all) {
      all(self.uncorrelated, self.coherent);
    }
  };
  static constexpr int kLargestExtent = 240;

  /// A map without nodes, to be read.
  IntensityMap() = default;
  /// Tabulates `f`. `extent` is the largest |u| needed; at most kLargestExtent is tabulated. `f` is called
  /// from the threads of `parallel_for`.
  IntensityMap(const std::function<MixtureIntensity(double, double)>& f, double extent,
               const ParallelFor& parallel_for = serial_for);

  /// Returns the largest |ux| and |uy| of the map. `eval` must not be called beyond it.
  float extent() const { return extents_[kLevels - 1]; }
  Pair eval(float ux, float uy) const {
    const float x[4] = {ux, 0, 0, 0}, y[4] = {uy, 0, 0, 0};
    float uncorrelated[4], coherent[4];
    eval<4>(x, y, uncorrelated, coherent);
    return {uncorrelated[0], coherent[0]};
  }
  /// Evaluates U and C at N points at once, with vectorised indices and weights. Points beyond the map take
  /// the values at its edge.
  template <int N>
  void eval(const float* ux, const float* uy, float* uncorrelated, float* coherent) const;
  /// Evaluates the points (x[i], y[i]): writes U to values[i] and C to values[x.size() + i].
  void eval(std::span<const double> x, std::span<const double> y, std::span<double> values) const;
  std::size_t bytes() const { return nodes_.size() * sizeof(Pair); }
  /// Calls `all` with the members, for tables that are kept; `self` is constant or not.
  template <class Self, class Fields>
  static void fields(Self& self, Fields& all) {
    all(self.extents_, self.rates_, self.columns_, self.first_, self.nodes_);
  }

private:
  template <int N>
  struct Vectors;
  static constexpr int kLevels = 5;
  float extents_[kLevels] = {},
        rates_[kLevels] = {};  // extent of each level, and its number of nodes per unit of u
  std::int32_t columns_[kLevels] = {}, first_[kLevels] = {};
  /// Nodes (U, C), level by level, for ux from -extent - step and uy from -step. The lower half plane is the
  /// upper one rotated by 180 degrees.
  std::vector<Pair> nodes_;
};

/// A member type instead of an alias: GCC drops a vector size that depends on a template parameter from an
/// alias.
template <int N>
struct IntensityMap::Vectors {
  typedef float Floats __attribute__((vector_size(sizeof(float) * N)));
  typedef std::int32_t Ints __attribute__((vector_size(sizeof(float) * N)));
};

template <int N>
void IntensityMap::eval(const float* ux, const float* uy, float* uncorrelated, float* coherent) const {
  using Floats = typename Vectors<N>::Floats;
  using Ints = typename Vectors<N>::Ints;
  Floats x, y;
  std::memcpy(&x, ux, sizeof x);
  std::memcpy(&y, uy, sizeof y);
  const Ints below = y < 0;
  x = below ? -x : x, y = below ? -y : y;
  const Floats ax = x < 0 ? -x : x, largest = ax > y ? ax : y;
  const auto all = [](float value) { return value - Floats{}; };
  Floats extent = all(extents_[kLevels - 1]), rate = all(rates_[kLevels - 1]);
  const auto all_ints = [](std::int32_t value) { return value - Ints{}; };
  Ints first = all_ints(first_[kLevels - 1]), columns = all_ints(columns_[kLevels - 1]);
  const float last = std::nextafter(extents_[kLevels - 1], 0.f);
  for (int l = kLevels - 2; l >= 0; --l) {
    const Ints inside = largest < all(extents_[l]);
    extent = inside ? all(extents_[l]) : extent, rate = inside ? all(rates_[l]) : rate;
    first = inside ? all_ints(first_[l]) : first, columns = inside ? all_ints(columns_[l]) : columns;
  }
  x = x > last ? all(last) : x < -last ? all(-last) : x, y = y < last ? y : all(last);
  x = (x + extent) * rate, y = y * rate;
  const Ints column = __builtin_convertvector(x, Ints), row = __builtin_convertvector(y, Ints);
  const Ints node = first + row * columns + column;
  // The Lagrange cubics through nodes at -1, 0, 1, 2.
  const auto weights = [](const Floats& t, Floats(&w)[4]) {
    const Floats a = t * (1 / 6.f), m = t - 1, p = t + 1, q = t - 2;
    w[0] = -a * m * q, w[1] = p * m * q * 0.5f, w[2] = -t * p * q * 0.5f, w[3] = a * p * m;
  };
  Floats wx[4], wy[4];
  weights(x - __builtin_convertvector(column, Floats), wx);
  weights(y - __builtin_convertvector(row, Floats), wy);
  for (int j = 0; j < N; ++j) {
    using Row = float __attribute__((vector_size(32), aligned(4)));  // four nodes
    using Half = float __attribute__((vector_size(16)));
    const Pair* p = &nodes_[std::size_t(node[j])];
    Row sum = *reinterpret_cast<const Row*>(p) * wy[0][j];
    for (int i = 1; i < 4; ++i) {
      p += columns[j];
      sum += *reinterpret_cast<const Row*>(p) * wy[i][j];
    }
    sum *= Row{wx[0][j], wx[0][j], wx[1][j], wx[1][j], wx[2][j], wx[2][j], wx[3][j], wx[3][j]};
    const Half half = Half{sum[0], sum[1], sum[2], sum[3]} + Half{sum[4], sum[5], sum[6], sum[7]};
    const float u = half[0] + half[2], c = half[1] + half[3];
    // The interpolant may be slightly negative next to zeros of order two.
    uncorrelated[j] = u > 0 ? u : 0, coherent[j] = c > 0 ? c : 0;
  }
}

}  // namespace aureole::optics
