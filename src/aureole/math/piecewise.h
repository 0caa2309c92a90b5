// SPDX-License-Identifier: Apache-2.0
// Piecewise constant distributions on [0, 1) and [0, 1)^2, with look-up tables that shorten the search.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "aureole/math/vec.h"

namespace aureole {

/// Piecewise constant pdf over n equal cells of [0, 1).
class Piecewise1D {
public:
  Piecewise1D() = default;
  /// Weights >= 0; if all are zero, the distribution is uniform.
  explicit Piecewise1D(std::span<const float> weights);

  /// Samples a point in [0, 1) and its pdf; `cell` receives the index of its cell.
  float sample(float u, float* pdf, std::size_t* cell = nullptr) const;
  float pdf(float x) const;
  double total() const { return total_; }  ///< sum of the weights
  std::size_t size() const { return cdf_.size() - 1; }

private:
  double total_ = 0;
  std::vector<float> cdf_;            ///< cumulative distribution: n + 1 values from 0 to 1
  std::vector<std::uint32_t> guide_;  ///< first cell that the search tests, by floor(u n)
};

/// Piecewise constant pdf over a grid of cells of [0, 1)^2: a marginal distribution over rows and a
/// conditional one in each row.
class Piecewise2D {
public:
  Piecewise2D() = default;
  Piecewise2D(std::span<const float> weights, int width, int height);  ///< `weights` are listed row by row
  Vec2 sample(Vec2 u, float* pdf) const;
  float pdf(Vec2 p) const;

private:
  /// Number of cells of a row for each entry of its guide: the tables of large maps compete for cache memory.
  static constexpr int kCellsPerGuide = 4;

  Piecewise1D marginal_;
  int width_ = 0, height_ = 0, guides_ = 0;
  std::vector<float> cdf_;  ///< cumulative distributions: width + 1 values per row, from 0 to 1
  /// for each row, the first cell that the search tests, by floor(u guides)
  std::vector<std::uint32_t> guide_;
};

}  // namespace aureole
