// SPDX-License-Identifier: Apache-2.0
// Sampling of tables over the unit square: J. Dupuy and W. Jakob, "An adaptive parameterization for efficient material
// acquisition and rendering", ACM TOG 37(6), 2018, section 4 and appendix. A table is bilinear between its nodes, and
// its pdf is sampled exactly: y by the marginal distribution, then x by the conditional one. Several tables (slices)
// belong to nodes of two parameters, such as azimuth and angle of incidence, and are blended linearly between them.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

#include "aureole/bsdf/measured/four.h"
#include "aureole/math/vec.h"

namespace aureole {

/// The slices of a table that belong to a pair of parameters, and their weights, which add up to one.
struct SliceBlend {
  std::array<std::uint32_t, 4> slice{};
  std::array<float, 4> weight{};
  int count = 0;
};

/// Nodes of the two parameters. Slices are ordered by the first one, then by the second.
struct SliceNodes {
  std::vector<float> first, second;

  std::size_t count() const { return first.size() * second.size(); }
  /// Interpolation between the nodes around the parameters (a, b). Parameters outside of the nodes are
  /// clamped to the nearest node.
  SliceBlend at(float a, float b) const;
};

/// The index i of the interval [nodes[i], nodes[i+1]] that contains x, and the position within it, in [0, 1]. 0 for a
/// single node.
struct NodePlace {
  std::size_t index = 0;
  float fraction = 0;
};
inline NodePlace place_among(std::span<const float> nodes, float x) {
  NodePlace place;
  if (nodes.size() < 2) return place;
  // The number of steps depends on the number of nodes alone, and no branch on x: random angles would make it
  // unpredictable.
  for (std::size_t left = nodes.size() - 2; left > 0;) {
    const std::size_t half = (left + 1) / 2;
    place.index += nodes[place.index + half] <= x ? half : 0;
    left -= half;
  }
  const float low = nodes[place.index], high = nodes[place.index + 1];
  place.fraction = std::clamp((x - low) / (high - low), 0.f, 1.f);
  return place;
}

inline SliceBlend SliceNodes::at(float a, float b) const {
  const NodePlace i = place_among(first, a), j = place_among(second, b);
  const std::uint32_t columns = std::uint32_t(second.size()),
                      low = std::uint32_t(i.index) * columns + std::uint32_t(j.index), high = low + columns;
  const float a0 = 1 - i.fraction, a1 = i.fraction, b0 = 1 - j.fraction, b1 = j.fraction;
  if (first.size() < 2) return {{low, low + 1}, {b0, b1}, columns > 1 ? 2 : 1};
  if (columns < 2) return {{low, high}, {a0, a1}, 2};
  return {{low, low + 1, high, high + 1}, {a0 * b0, a0 * b1, a1 * b0, a1 * b1}, 4};
}

/// The cell of a grid of nodes over [0, 1] that contains x, and the position within it.
struct GridCell {
  int index;
  float fraction;

  GridCell(float x, int nodes) {
    // The comparison is also false for NaN, which becomes 0.
    const float scaled = x > 0 ? std::min(x, 1.f) * float(nodes - 1) : 0.f;
    index = std::min(int(scaled), nodes - 2);
    fraction = scaled - float(index);
  }
};

/// The cell of a table over the unit square that contains a point, and the position within it.
struct SquareCell {
  std::size_t node;  ///< index of the node at the lower left corner, counted row by row
  int row;           ///< row of that node
  float s, t;        ///< positions along x and y, in [0, 1]

  SquareCell(Vec2 p, int width, int height) {
    const GridCell x(p.x, width), y(p.y, height);
    row = y.index;
    node = std::size_t(row) * std::size_t(width) + std::size_t(x.index);
    s = x.fraction, t = y.fraction;
  }
};

/// Two neighbours of an array of pairs of numbers.
template <class Pair>
inline Four four_at(const Pair* pair) {
  static_assert(sizeof(Pair) == 8);
  Four four;
  std::memcpy(&four, pair, sizeof four);
  return four;
}

/// Tables of width x height values over the unit square with values at its corners and edges.
class BilinearWarp {
public:
  BilinearWarp() = default;
  /// `values`: slices one after the other, each row by row; none is negative. Each slice is scaled to the integral 1;
  /// a slice of zeros becomes the constant 1. `width` and `height` are 2 or more.
  BilinearWarp(int width, int height, std::size_t slices, std::span<const float> values);

  struct Point {
    Vec2 p;
    float pdf = 0;  ///< pdf with respect to the area of the unit square
  };
  /// Maps a uniform point of the unit square to a point distributed as the blend of slices.
  Point sample(Vec2 u, const SliceBlend& blend) const;
  /// The inverse of `sample`: the uniform point that is mapped to `p`, with the pdf at p.
  Point invert(Vec2 p, const SliceBlend& blend) const;
  /// The pdf at a point in a cell of this table.
  float pdf(const SquareCell& cell, const SliceBlend& blend) const {
    const std::size_t size = std::size_t(width_) * std::size_t(height_);
    Four nodes{};
    for (int k = 0; k < blend.count; ++k) {
      const Node* low = nodes_.data() + blend.slice[std::size_t(k)] * size + cell.node;
      nodes += blend.weight[std::size_t(k)] * ((1 - cell.t) * four_at(low) + cell.t * four_at(low + width_));
    }
    return (1 - cell.s) * nodes[0] + cell.s * nodes[2];
  }
  float pdf(Vec2 p, const SliceBlend& blend) const { return pdf(SquareCell(p, width_, height_), blend); }
  int width() const { return width_; }
  int height() const { return height_; }
  std::size_t bytes() const { return nodes_.size() * sizeof(Node) + rows_.size() * sizeof(Row); }

private:
  /// The value at a node, and the integral of its row from the left edge to the node.
  struct Node {
    float value, cumulated;
  };
  /// The integral of a row, and the integral of the table from the lower edge to it.
  struct Row {
    float integral, cumulated;
  };
  int width_ = 0, height_ = 0;
  std::vector<Node> nodes_;
  std::vector<Row> rows_;
};

/// A table over the unit square that is evaluated alone: bilinear, with values as given.
class BilinearTable {
public:
  BilinearTable() = default;
  BilinearTable(int width, int height, std::vector<float> values)
      : width_(width), height_(height), values_(std::move(values)) {}
  float at(Vec2 p) const {
    const SquareCell cell(p, width_, height_);
    const float *low = values_.data() + cell.node, *high = low + width_;
    return (1 - cell.t) * ((1 - cell.s) * low[0] + cell.s * low[1]) +
           cell.t * ((1 - cell.s) * high[0] + cell.s * high[1]);
  }

private:
  int width_ = 0, height_ = 0;
  std::vector<float> values_;
};

}  // namespace aureole
