// SPDX-License-Identifier: Apache-2.0
#include "aureole/math/piecewise.h"

#include <algorithm>
#include <cstdint>

namespace aureole {

Piecewise1D::Piecewise1D(std::span<const float> weights) : cdf_(weights.size() + 1), guide_(weights.size()) {
  const size_t n = weights.size();
  for (float w : weights) total_ += w;
  double below = 0;
  for (size_t i = 0; i < n; ++i) {
    below += total_ > 0 ? weights[i] / total_ : 1.0 / double(n);
    cdf_[i + 1] = std::min(float(below), 1.f);
  }
  // Cells of no weight at the end must not catch rounding: the last cell with weight ends at exactly 1.
  float last = 1.f;
  for (size_t i = n; i > 0; --i) {
    const bool empty = total_ > 0 && !(weights[i - 1] > 0);
    cdf_[i] = last;
    if (!empty) break;
  }
  size_t cell = 0;
  for (size_t k = 0; k < n; ++k) {
    while (cell + 1 < n && cdf_[cell + 1] <= float(k) / float(n)) ++cell;
    guide_[k] = std::uint32_t(cell);
  }
}

float Piecewise1D::sample(float u, float* pdf, std::size_t* cell) const {
  const size_t n = size();
  // The guide may be one cell late through rounding of u n: step back if so.
  size_t i = guide_[std::min(size_t(u * float(n)), n - 1)];
  while (i > 0 && cdf_[i] > u) --i;
  while (i + 1 < n && cdf_[i + 1] <= u) ++i;
  const float mass = cdf_[i + 1] - cdf_[i];
  if (pdf) *pdf = mass * float(n);
  if (cell) *cell = i;
  const float within = mass > 0 ? std::min((u - cdf_[i]) / mass, 1.f) : 0.5f;
  return std::min((float(i) + within) / float(n), 0x1.fffffep-1f);  // the sum may be rounded up to n
}

float Piecewise1D::pdf(float x) const {
  const size_t i = std::min(size_t(std::max(0.f, x) * float(size())), size() - 1);
  return (cdf_[i + 1] - cdf_[i]) * float(size());
}

Piecewise2D::Piecewise2D(std::span<const float> weights, int width, int height) {
  std::vector<float> totals;
  for (int y = 0; y < height; ++y) {
    rows_.emplace_back(weights.subspan(size_t(y) * size_t(width), size_t(width)));
    totals.push_back(float(rows_.back().total()));
  }
  marginal_ = Piecewise1D(totals);
}

Vec2 Piecewise2D::sample(Vec2 u, float* pdf) const {
  float pdf_y, pdf_x;
  size_t row;
  const float y = marginal_.sample(u.y, &pdf_y, &row);
  const float x = rows_[row].sample(u.x, &pdf_x);
  *pdf = pdf_x * pdf_y;
  return {x, y};
}

float Piecewise2D::pdf(Vec2 p) const {
  const size_t row = std::min(size_t(std::max(0.f, p.y) * float(rows_.size())), rows_.size() - 1);
  return marginal_.pdf(p.y) * rows_[row].pdf(p.x);
}

}  // namespace aureole
