// SPDX-License-Identifier: Apache-2.0
#include "aureole/phase/table/hemisphere_table.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "aureole/math/warp.h"

namespace aureole {

namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;

}  // namespace

HemisphereTable::HemisphereTable(std::span<const double> x, std::span<const double> values,
                                 std::size_t columns)
    : stride_(columns), nodes_(x.begin(), x.end()), values_(values.begin(), values.end()) {
  if (x.size() < 2 || x.front() != 0 || x.back() != 1 || values.size() != x.size() * columns)
    throw std::logic_error("nodes of a hemisphere run from 0 to 1, each with all columns");
  if (x.size() > std::numeric_limits<std::uint16_t>::max())
    throw std::logic_error("too many nodes of a hemisphere");
  for (std::size_t i = 0; i + 1 < x.size(); ++i) {
    const double width = x[i + 1] - x[i];
    if (!(width > 0)) throw std::logic_error("nodes of a hemisphere must increase");
    cells_.push_back({float(x[i]), float(1 / width)});
  }
  integrals_.assign(columns, 0.0);
  for (std::size_t i = 0; i < cells_.size(); ++i)
    for (std::size_t c = 0; c < columns; ++c)
      integrals_[c] +=
          kTwoPi * (x[i + 1] - x[i]) * 0.5 * (values[i * columns + c] + values[(i + 1) * columns + c]);
  make_guide();
}

void HemisphereTable::make_guide() {
  // Buckets of the guide are made finer until each contains few nodes.
  constexpr int kMaxInBucket = 3, kFinestBits = 8, kMantissaBits = 23;
  const float first = float(nodes_[1]);
  guide_base_ = std::bit_cast<int>(first);
  const int end = std::bit_cast<int>(1.f);
  for (int bits = 1; bits <= kFinestBits; ++bits) {
    guide_shift_ = kMantissaBits - bits;
    std::vector<std::uint16_t> count(std::size_t((end - guide_base_) >> guide_shift_) + 1, 0);
    for (std::size_t i = 1; i + 1 < nodes_.size(); ++i)
      ++count[std::size_t((std::bit_cast<int>(float(nodes_[i])) - guide_base_) >> guide_shift_)];
    guide_.assign(count.size(), 0);
    // First cell of each bucket: the cell that contains the bucket's start, which is the number of nodes
    // before it, not counting the node at zero. The first bucket also serves smaller x.
    std::size_t before = 0;
    for (std::size_t k = 0; k < count.size(); ++k) guide_[k] = std::uint16_t(before), before += count[k];
    if (*std::max_element(count.begin(), count.end()) <= kMaxInBucket) break;
  }
}

HemisphereTable::Place HemisphereTable::find(float x) const {
  x = std::min(x, 1.f);
  const int bits = std::max(std::bit_cast<int>(x) - guide_base_, 0);
  int cell = guide_[std::size_t(bits >> guide_shift_)];
  const int last = int(cells_.size()) - 1;
  float fraction = (x - cells_[cell].begin) * cells_[cell].rate;
  while (fraction > 1 && cell < last) ++cell, fraction = (x - cells_[cell].begin) * cells_[cell].rate;
  return {cell, std::clamp(fraction, 0.f, 1.f)};
}

double HemisphereTable::first_moment(int column) const {
  double sum = 0;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const double a = nodes_[i], b = nodes_[i + 1], f = double(values_[i * stride_ + std::size_t(column)]),
                 g = double(values_[(i + 1) * stride_ + std::size_t(column)]);
    sum += kTwoPi * (b - a) * (f * (2 * a + b) + g * (a + 2 * b)) / 6;
  }
  return sum;
}

void HemisphereTable::scale(int column, double factor) {
  for (std::size_t i = std::size_t(column); i < values_.size(); i += stride_)
    values_[i] = float(double(values_[i]) * factor);
  integrals_[std::size_t(column)] *= factor;
}

void HemisphereTable::prepare_samples() {
  const std::size_t nodes = nodes_.size(), cells = cells_.size();
  shares_.resize(nodes * stride_);
  share_guide_.resize(cells * stride_);
  for (std::size_t c = 0; c < stride_; ++c) {
    float* shares = &shares_[c * nodes];
    double sum = 0;
    shares[0] = 0;
    for (std::size_t i = 0; i < cells; ++i) {
      sum += kTwoPi * (nodes_[i + 1] - nodes_[i]) * 0.5 *
             (double(values_[i * stride_ + c]) + double(values_[(i + 1) * stride_ + c]));
      shares[i + 1] = float(sum);
    }
    std::size_t cell = 0;
    for (std::size_t k = 0; k < cells; ++k) {
      const float begin = shares[cells] * (float(k) / float(cells));
      while (cell + 1 < cells && shares[cell + 1] <= begin) ++cell;
      share_guide_[c * cells + k] = std::uint16_t(cell);
    }
  }
}

HemisphereTable::Place HemisphereTable::sample(int column, float share) const {
  const std::size_t cells = cells_.size();
  const float* shares = &shares_[std::size_t(column) * nodes_.size()];
  const std::uint16_t* guide = &share_guide_[std::size_t(column) * cells];
  const float total = shares[cells];
  // The share is clamped below the total, so that the cell found has a positive integral.
  share = std::min(share, total * kOneMinusEpsilon);
  const std::size_t k = std::min(std::size_t(share / total * float(cells)), cells - 1);
  // Rounding may shift the guide by one bucket.
  const std::size_t low = guide[k > 0 ? k - 1 : 0], high = k + 2 < cells ? guide[k + 2] : cells - 1;
  const std::size_t cell =
      std::size_t(std::upper_bound(shares + low + 1, shares + high + 1, share) - shares) - 1;

  const float mass = shares[cell + 1] - shares[cell];
  // The result stays off the ends of a cell, where the density may be zero.
  const float r = mass > 0 ? std::clamp((share - shares[cell]) / mass, 0x1p-24f, kOneMinusEpsilon) : 0.5f;
  const float a = values_[cell * stride_ + std::size_t(column)],
              b = values_[(cell + 1) * stride_ + std::size_t(column)];
  // Position as the root of (a f + (b - a) f^2/2) / ((a + b)/2) = r.
  const float root = std::sqrt(a * a + r * (b * b - a * a)), d = a + root;
  return {int(cell), d > 0 ? std::min(r * (a + b) / d, 1.f) : 0.f};
}

std::size_t HemisphereTable::bytes() const {
  return sizeof(double) * nodes_.size() + sizeof(Cell) * cells_.size() +
         sizeof(float) * (values_.size() + shares_.size()) +
         sizeof(std::uint16_t) * (guide_.size() + share_guide_.size());
}

}  // namespace aureole
