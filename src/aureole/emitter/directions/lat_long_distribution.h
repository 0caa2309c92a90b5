// SPDX-License-Identifier: Apache-2.0
// Directions in proportion to a latitude-longitude map times the cosine with a receiving normal, with their
// density in closed form. The map is divided into 32 x 16 blocks. A block is found by hierarchical warping
// (Clarberg et al. 2005, "Wavelet importance sampling") over three levels of eight cells, whose integrals
// against the clamped cosine of the very normal are estimated from the cells' directional moments; inside a
// block the map alone is followed.
#pragma once

#include <span>
#include <vector>

#include "aureole/math/transform.h"
#include "aureole/math/vec.h"

namespace aureole {

class LatLongDistribution {
public:
  /// The map has this many blocks, and a multiple of them in cells.
  static constexpr int kBlockColumns = 32, kBlockRows = 16;

  LatLongDistribution() = default;
  /// Weights >= 0 of equal cells of uv (which include the sine of the polar angle), row by row; `columns` and
  /// `rows` are multiples of the numbers of blocks. u = 0 looks along local -z and grows towards +x, v = 0 is
  /// +y; `frame` takes local directions to the world. All zero: uniform.
  LatLongDistribution(std::span<const float> weights, int columns, int rows, const Frame& frame);

  /// A point of the map for a surface with the normal `facing` (zero: light counts from all sides alike), and
  /// its density over uv. Directions below the horizon do occur, near it. Density 0: there is nothing.
  Vec2 sample(const Vec3& facing, Vec2 u, float* pdf) const;
  /// Density over uv, positive for every `facing` wherever the weight is.
  float pdf(const Vec3& facing, Vec2 uv) const;

private:
  using Octet = float __attribute__((vector_size(32)));
  static constexpr int kCovariances = 6;  ///< xx, yy, zz, xy, yz, xz
  /// The eight parts of a cell: their masses, and the mean and scaled covariance of world directions in each.
  struct Node {
    Octet mass, mean[3], covariance[kCovariances];
  };
  struct Receiver;
  struct Moments;

  void build_nodes(std::span<const float> weights, const Frame& frame);
  void build_blocks(std::span<const float> weights);

  int block_width_ = 0, block_height_ = 0;  ///< in cells
  std::vector<Node> nodes_;                 ///< 1 + 8 + 64
  /// Per block: for its rows, then for the cells of each row, the share that lies before their end.
  std::vector<float> cdf_;
};

}  // namespace aureole
