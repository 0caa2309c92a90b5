// SPDX-License-Identifier: Apache-2.0
// Piecewise-constant distributions on [0, 1] and [0, 1]^2, with look-up tables that make the search short.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "aureole/math/vec.h"

namespace aureole {

/// Piecewise-constant density over n equal cells of [0, 1).
class Piecewise1D {
public:
  Piecewise1D() = default;
  /// Weights >= 0. All zero: uniform.
  explicit Piecewise1D(std::span<const float> weights);

  /// A point in [0, 1) with its density; `cell` receives its cell.
  float sample(float u, float* pdf, std::size_t* cell = nullptr) const;
  float pdf(float x) const;
  double total() const { return total_; }  ///< sum of the weights
  std::size_t size() const { return cdf_.size() - 1; }

private:
  double total_ = 0;
  std::vector<float> cdf_;            ///< n + 1, from 0 to 1
  std::vector<std::uint32_t> guide_;  ///< first cell to look at for floor(u n)
};

/// Piecewise-constant density over a grid of cells of [0, 1)^2: a marginal over rows and a conditional in
/// each row.
class Piecewise2D {
public:
  Piecewise2D() = default;
  Piecewise2D(std::span<const float> weights, int width, int height);  ///< weights row by row
  Vec2 sample(Vec2 u, float* pdf) const;
  float pdf(Vec2 p) const;

private:
  /// Of the cells of a row one in four has an entry: the tables of a large map compete for the caches.
  static constexpr int kCellsPerGuide = 4;

  Piecewise1D marginal_;
  int width_ = 0, height_ = 0, guides_ = 0;
  std::vector<float> cdf_;            ///< width + 1 per row, from 0 to 1
  std::vector<std::uint32_t> guide_;  ///< per row, for floor(u guides): the first cell to look at
};

}  // namespace aureole
