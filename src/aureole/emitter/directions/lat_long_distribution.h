// SPDX-License-Identifier: Apache-2.0
// Samples directions in proportion to a latitude-longitude map times the cosine with a receiving normal, with
// a pdf in closed form. The map is divided into 32 x 16 blocks. A block is found by hierarchical warping
// (Clarberg et al. 2005, "Wavelet importance sampling") over three levels of eight cells. Their integrals
// against the clamped cosine of the actual normal are estimated from the cells' directional moments. Inside a
// block, sampling follows the map alone.
#pragma once

#include <span>
#include <vector>

#include "aureole/math/transform.h"
#include "aureole/math/vec.h"

namespace aureole {

class LatLongDistribution {
public:
  /// Number of blocks; the numbers of cells of the map are multiples of them.
  static constexpr int kBlockColumns = 32, kBlockRows = 16;

  LatLongDistribution() = default;
  /// `weights` >= 0 of equal cells of uv, which include the sine of the polar angle, row by row. `columns`
  /// and `rows` are multiples of the numbers of blocks. u = 0 is the direction local -z, and u grows towards
  /// +x; v = 0 is +y. `frame` transforms local directions to the world. If all weights are zero, sampling is
  /// uniform.
  LatLongDistribution(std::span<const float> weights, int columns, int rows, const Frame& frame);

  /// Samples a point of the map for a surface with the normal `facing` (zero: all sides count equally), and
  /// its pdf over uv. Directions slightly below the receiver's horizon can occur. A pdf of 0 means that
  /// nothing was sampled.
  Vec2 sample(const Vec3& facing, Vec2 u, float* pdf) const;
  /// Pdf over uv, positive for every `facing` wherever the weight is positive.
  float pdf(const Vec3& facing, Vec2 uv) const;

private:
  using Octet = float __attribute__((vector_size(32)));
  static constexpr int kCovariances = 6;  ///< covariances xx, yy, zz, xy, yz, xz
  /// The eight children of a cell: their masses, and the mean and scaled covariance of the world directions
  /// in each.
  struct Node {
    Octet mass, mean[3], covariance[kCovariances];
  };
  struct Receiver;
  struct Moments;

  void build_nodes(std::span<const float> weights, const Frame& frame);
  void build_blocks(std::span<const float> weights);

  int block_width_ = 0, block_height_ = 0;  ///< size of a block in cells
  std::vector<Node> nodes_;                 ///< nodes of the three levels, 1 + 8 + 64
  /// Per block: the CDF of its rows, then the CDF of the cells of each row.
  std::vector<float> cdf_;
};

}  // namespace aureole
