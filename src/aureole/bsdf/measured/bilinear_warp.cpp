// SPDX-License-Identifier: Apache-2.0
#include "aureole/bsdf/measured/bilinear_warp.h"

#include <algorithm>
#include <cmath>

#include "aureole/core/parallel.h"

namespace aureole {
namespace {

/// Solves a t + (b - a) t^2 / 2 = area for t in [0, 1]: the position up to which a linear density from a to b
/// integrates to `area`.
float solve_linear(float a, float b, float area) {
  const float root = std::sqrt(std::max(a * a + 2 * (b - a) * area, 0.f)), sum = a + root;
  return sum > 0 ? std::clamp(2 * area / sum, 0.f, 1.f) : 0.5f;
}
float integrate_linear(float a, float b, float t) { return t * (a + 0.5f * (b - a) * t); }

/// The largest i in [0, last] for which value(i) <= x, where value increases.
template <class Value>
int last_not_above(int last, float x, Value&& value) {
  int low = 0, high = last;
  while (low < high) {
    const int middle = (low + high + 1) / 2;
    if (value(middle) <= x)
      low = middle;
    else
      high = middle - 1;
  }
  return low;
}

}  // namespace

BilinearWarp::BilinearWarp(int width, int height, std::size_t slices, std::span<const float> values)
    : width_(width), height_(height), nodes_(values.size()), rows_(slices * std::size_t(height)) {
  const std::size_t w = std::size_t(width), h = std::size_t(height);
  const auto build_slice = [&](std::size_t slice) {
    const float* from = values.data() + slice * w * h;
    Node* nodes = nodes_.data() + slice * w * h;
    Row* rows = rows_.data() + slice * h;
    std::vector<double> integrals(h);
    double total = 0;
    for (std::size_t y = 0; y < h; ++y) {
      for (std::size_t x = 1; x < w; ++x)
        integrals[y] += 0.5 * (double(from[y * w + x - 1]) + double(from[y * w + x])) / double(w - 1);
      if (y > 0) total += 0.5 * (integrals[y - 1] + integrals[y]) / double(h - 1);
    }
    const bool is_empty = !(total > 0) || !std::isfinite(total);
    const double scale = is_empty ? 1 : 1 / total;
    double cumulated_rows = 0;
    for (std::size_t y = 0; y < h; ++y) {
      double cumulated = 0;
      for (std::size_t x = 0; x < w; ++x) {
        const double value = is_empty ? 1 : scale * double(from[y * w + x]);
        if (x > 0) cumulated += 0.5 * (double(nodes[y * w + x - 1].value) + value) / double(w - 1);
        nodes[y * w + x] = {float(value), float(cumulated)};
      }
      if (y > 0) cumulated_rows += 0.5 * (double(rows[y - 1].integral) + cumulated) / double(h - 1);
      rows[y] = {float(cumulated), float(cumulated_rows)};
    }
  };
  for_ranges(
      slices,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t slice = begin; slice < end; ++slice) build_slice(slice);
      },
      1);
}

BilinearWarp::Point BilinearWarp::sample(Vec2 u, const SliceBlend& blend) const {
  const std::size_t size = std::size_t(width_) * std::size_t(height_);
  const auto row_sum = [&](int y, float Row::*of) {
    float sum = 0;
    for (int k = 0; k < blend.count; ++k)
      sum += blend.weight[std::size_t(k)] *
             (rows_[blend.slice[std::size_t(k)] * std::size_t(height_) + std::size_t(y)].*of);
    return sum;
  };
  const auto node_sum = [&](int x, int y, float Node::*of) {
    const std::size_t at = std::size_t(y) * std::size_t(width_) + std::size_t(x);
    float sum = 0;
    for (int k = 0; k < blend.count; ++k)
      sum += blend.weight[std::size_t(k)] * (nodes_[blend.slice[std::size_t(k)] * size + at].*of);
    return sum;
  };
  const int y = last_not_above(height_ - 2, u.y, [&](int i) { return row_sum(i, &Row::cumulated); });
  const float r0 = row_sum(y, &Row::integral), r1 = row_sum(y + 1, &Row::integral);
  const float t = solve_linear(r0, r1, (u.y - row_sum(y, &Row::cumulated)) * float(height_ - 1));
  const auto between = [&](int x, float Node::*of) {
    return (1 - t) * node_sum(x, y, of) + t * node_sum(x, y + 1, of);
  };
  const float target = u.x * ((1 - t) * r0 + t * r1);
  const int x = last_not_above(width_ - 2, target, [&](int i) { return between(i, &Node::cumulated); });
  const float c0 = between(x, &Node::value), c1 = between(x + 1, &Node::value);
  const float s = solve_linear(c0, c1, (target - between(x, &Node::cumulated)) * float(width_ - 1));
  return {{(float(x) + s) / float(width_ - 1), (float(y) + t) / float(height_ - 1)}, (1 - s) * c0 + s * c1};
}

BilinearWarp::Point BilinearWarp::invert(Vec2 p, const SliceBlend& blend) const {
  const SquareCell cell(p, width_, height_);
  const float s = cell.s, t = cell.t;
  const std::size_t size = std::size_t(width_) * std::size_t(height_);
  // A pair of nodes, or of rows, is four numbers that lie together.
  Four rows{}, nodes{};
  for (int k = 0; k < blend.count; ++k) {
    const float weight = blend.weight[std::size_t(k)];
    const std::size_t slice = blend.slice[std::size_t(k)];
    const Node* low = nodes_.data() + slice * size + cell.node;
    rows += weight * four_at(rows_.data() + slice * std::size_t(height_) + std::size_t(cell.row));
    nodes += weight * ((1 - t) * four_at(low) + t * four_at(low + width_));
  }
  const float r0 = rows[0], below = rows[1], r1 = rows[2], c0 = nodes[0], left = nodes[1], c1 = nodes[2];
  const float row = (1 - t) * r0 + t * r1;
  Point found;
  found.p.y = below + integrate_linear(r0, r1, t) / float(height_ - 1);
  found.p.x = row > 0 ? (left + integrate_linear(c0, c1, s) / float(width_ - 1)) / row : 0.5f;
  found.pdf = (1 - s) * c0 + s * c1;
  return found;
}

}  // namespace aureole
