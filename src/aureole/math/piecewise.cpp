// SPDX-License-Identifier: Apache-2.0
#include "aureole/math/piecewise.h"

#include <algorithm>
#include <cstdint>

namespace aureole {

namespace {

/// Fills the CDF of n + 1 values from 0 to 1 and returns the sum of the weights; uniform if all weights are
/// zero.
double accumulate(std::span<const float> weights, float* cdf) {
  const size_t n = weights.size();
  double total = 0, below = 0;
  for (float w : weights) total += w;
  cdf[0] = 0;
  for (size_t i = 0; i < n; ++i) {
    below += total > 0 ? weights[i] / total : 1.0 / double(n);
    cdf[i + 1] = std::min(float(below), 1.f);
  }
  // Rounding must not give trailing cells of weight 0 a probability: the last cell with a positive weight
  // ends at exactly 1.
  for (size_t i = n; i > 0; --i) {
    cdf[i] = 1;
    if (!(total > 0) || weights[i - 1] > 0) break;
  }
  return total;
}

/// For each of `guides` equal intervals of [0, 1), stores the cell that contains the interval's beginning.
void make_guide(const float* cdf, size_t n, size_t guides, std::uint32_t* guide) {
  size_t cell = 0;
  for (size_t k = 0; k < guides; ++k) {
    while (cell + 1 < n && cdf[cell + 1] <= float(k) / float(guides)) ++cell;
    guide[k] = std::uint32_t(cell);
  }
}

float invert(const float* cdf, size_t n, const std::uint32_t* guide, size_t guides, float u, float* pdf,
             size_t* cell) {
  // Rounding of u n may make the guide one cell too high; the search steps back in that case.
  size_t i = guide[std::min(size_t(u * float(guides)), guides - 1)];
  while (i > 0 && cdf[i] > u) --i;
  while (i + 1 < n && cdf[i + 1] <= u) ++i;
  const float mass = cdf[i + 1] - cdf[i];
  if (pdf) *pdf = mass * float(n);
  if (cell) *cell = i;
  const float within = mass > 0 ? std::min((u - cdf[i]) / mass, 1.f) : 0.5f;
  // the sum may round up to n, so that the result is kept below 1
  return std::min((float(i) + within) / float(n), 0x1.fffffep-1f);
}

}  // namespace

Piecewise1D::Piecewise1D(std::span<const float> weights) : cdf_(weights.size() + 1), guide_(weights.size()) {
  total_ = accumulate(weights, cdf_.data());
  make_guide(cdf_.data(), weights.size(), guide_.size(), guide_.data());
}

float Piecewise1D::sample(float u, float* pdf, std::size_t* cell) const {
  return invert(cdf_.data(), size(), guide_.data(), guide_.size(), u, pdf, cell);
}

float Piecewise1D::pdf(float x) const {
  const size_t i = std::min(size_t(std::max(0.f, x) * float(size())), size() - 1);
  return (cdf_[i + 1] - cdf_[i]) * float(size());
}

Piecewise2D::Piecewise2D(std::span<const float> weights, int width, int height)
    : width_(width),
      height_(height),
      guides_((width + kCellsPerGuide - 1) / kCellsPerGuide),
      cdf_(size_t(width + 1) * size_t(height)),
      guide_(size_t(guides_) * size_t(height)) {
  std::vector<float> totals;
  for (int y = 0; y < height; ++y) {
    float* cdf = &cdf_[size_t(y) * size_t(width + 1)];
    totals.push_back(float(accumulate(weights.subspan(size_t(y) * size_t(width), size_t(width)), cdf)));
    make_guide(cdf, size_t(width), size_t(guides_), &guide_[size_t(y) * size_t(guides_)]);
  }
  marginal_ = Piecewise1D(totals);
}

Vec2 Piecewise2D::sample(Vec2 u, float* pdf) const {
  float pdf_y, pdf_x;
  size_t row;
  const float y = marginal_.sample(u.y, &pdf_y, &row);
  const float x = invert(&cdf_[row * size_t(width_ + 1)], size_t(width_), &guide_[row * size_t(guides_)],
                         size_t(guides_), u.x, &pdf_x, nullptr);
  *pdf = pdf_x * pdf_y;
  return {x, y};
}

float Piecewise2D::pdf(Vec2 p) const {
  const size_t row = std::min(size_t(std::max(0.f, p.y) * float(height_)), size_t(height_ - 1));
  const size_t i = std::min(size_t(std::max(0.f, p.x) * float(width_)), size_t(width_ - 1));
  const float* cdf = &cdf_[row * size_t(width_ + 1)];
  return (cdf[i + 1] - cdf[i]) * float(width_) * marginal_.pdf(p.y);
}

}  // namespace aureole
