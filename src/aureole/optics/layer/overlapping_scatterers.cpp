// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/layer/overlapping_scatterers.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "aureole/optics/constants.h"

namespace aureole::optics {
namespace {

// Lengths in this file are in units of the reach R of the scatterers, so that v = u R.

/// Period of the samples. Autocorrelations w end at |r| = 2, so that with a period of 4.2 samples of w
/// determine samples of its transform W, and vice versa.
constexpr double kPeriod = 4.2;
/// W is sampled up to |v| = kHalf 2 pi/kPeriod = 90.
constexpr int kHalf = 60, kSide = 2 * kHalf + 1;
constexpr double kStep = kPeriod / kSide;
/// Nodes of the result: kRate per unit of v, up to kEnd. Beyond, the result falls as v^-5 and is neglected
/// beside W, which falls as v^-3.
constexpr double kRate = 10, kEnd = 60;

std::complex<double> phase(double x) { return {std::cos(x), std::sin(x)}; }

}  // namespace

// The transform of exp(rho w) - 1 falls as slowly as W, since w has a cusp at 0: shapes have edges. Without
// growth rho w, which has the same cusp and a known transform, it falls faster by v^2, and a truncated sum
// suffices.
OverlappingScatterers::OverlappingScatterers(const Independent& independent, double mean_square, double reach,
                                             double density, bool isotropic, const ParallelFor& parallel_for)
    : density_(density),
      growth_(std::exp(density * mean_square)),
      mean_square_(mean_square),
      rate_(kRate * reach),
      isotropic_(isotropic) {
  // Autocorrelation w over one period, from W: first the sum over the columns of each row of frequencies,
  // then over the rows.
  const double spacing = 2 * kPi / kPeriod;
  std::vector<std::complex<double>> turns(kSide);
  for (int i = 0; i < kSide; ++i) turns[i] = phase(2 * kPi * i / kSide);
  const auto turn = [&](int k, int j) { return turns[std::size_t((k * j % kSide + kSide) % kSide)]; };
  std::vector<double> values(std::size_t(kSide) * (kHalf + 1));  // values of W at vy >= 0; W is even
  for (int y = 0; y <= kHalf; ++y)
    for (int x = -kHalf; x <= kHalf; ++x)
      values[std::size_t(y * kSide + x + kHalf)] =
          isotropic && x < 0 ? values[std::size_t(y * kSide - x + kHalf)]
                             : independent(x * spacing / reach, y * spacing / reach);
  if (isotropic)
    for (int y = 0; y <= kHalf; ++y)
      for (int x = 0; x < kHalf; ++x)
        values[std::size_t(y * kSide + x)] = values[std::size_t(y * kSide + 2 * kHalf - x)];
  std::vector<std::complex<double>> rows(std::size_t(kSide) * (kHalf + 1));
  for (int y = 0; y <= kHalf; ++y)
    for (int j = -kHalf; j <= kHalf; ++j) {
      std::complex<double> sum = 0;
      for (int x = -kHalf; x <= kHalf; ++x) sum += values[std::size_t(y * kSide + x + kHalf)] * turn(x, j);
      rows[std::size_t(y * kSide + j + kHalf)] = sum;
    }
  // Function (exp(rho w) - 1 - growth rho w)/rho, with w in units of a^2, W in a^4 and u in 1/a.
  const double scale = std::pow(spacing / (2 * kPi * reach), 2);
  std::vector<double> rest(std::size_t(kSide) * kSide);
  for (int i = -kHalf; i <= kHalf; ++i)
    for (int j = -kHalf; j <= kHalf; ++j) {
      double sum = rows[std::size_t(j + kHalf)].real();
      for (int y = 1; y <= kHalf; ++y)
        sum += 2 * (rows[std::size_t(y * kSide + j + kHalf)] * turn(y, i)).real();
      const double w = std::hypot(i, j) * kStep > 2 ? 0 : std::clamp(scale * sum, 0.0, mean_square);
      rest[std::size_t((i + kHalf) * kSide + j + kHalf)] = std::expm1(density * w) / density - growth_ * w;
    }

  // Transform of that function at the nodes, by two sums as above; lengths are relative to R, so that the
  // area is in units of R^2.
  const int half = int(kEnd * kRate) + 1;
  columns_ = 2 * half + 1, rows_ = isotropic ? 1 : half + 2;
  const double area = std::pow(kStep * reach, 2);
  std::vector<std::complex<double>> lines(std::size_t(kSide) * columns_);
  const auto for_columns = [&](const std::function<void(int)>& f) {
    parallel_for(
        std::size_t(columns_),
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t column = begin; column < end; ++column) f(int(column));
        },
        16);
  };
  nodes_.assign(std::size_t(columns_) * rows_, 0);
  for_columns([&](int column) {
    std::complex<double> factors[kSide];
    for (int j = 0; j < kSide; ++j) factors[j] = phase(-(column - half) / kRate * (j - kHalf) * kStep);
    for (int i = 0; i < kSide; ++i) {
      std::complex<double> sum = 0;
      for (int j = 0; j < kSide; ++j) sum += rest[std::size_t(i * kSide + j)] * factors[j];
      lines[std::size_t(column) * kSide + std::size_t(i)] = sum;
    }
    for (int row = 0; row < rows_; ++row) {
      double sum = 0;
      const double vy = isotropic_ ? 0 : (row - 1) / kRate;
      std::complex<double> factor = phase(vy * kHalf * kStep);
      const std::complex<double> step = phase(-vy * kStep);
      for (int i = 0; i < kSide; ++i, factor *= step)
        sum += (lines[std::size_t(column) * kSide + std::size_t(i)] * factor).real();
      nodes_[std::size_t(row) * columns_ + std::size_t(column)] = area * sum;
    }
  });
}

/// Interpolates the nodes of the transform by cubics.
double OverlappingScatterers::edge(double ux, double uy) const {
  if (isotropic_) ux = std::hypot(ux, uy), uy = 0;
  if (uy < 0) ux = -ux, uy = -uy;
  const double x = ux * rate_ + 0.5 * (columns_ - 1), y = uy * rate_ + 1;
  if (!(x >= 1 && x < columns_ - 2 && (isotropic_ || y < rows_ - 2))) return 0;
  const auto weights = [](double t, double(&w)[4]) {
    w[0] = -t * (t - 1) * (t - 2) / 6, w[1] = (t + 1) * (t - 1) * (t - 2) / 2;
    w[2] = -(t + 1) * t * (t - 2) / 2, w[3] = (t + 1) * t * (t - 1) / 6;
  };
  const int column = int(x), row = isotropic_ ? 0 : int(y);
  double wx[4], wy[4];
  weights(x - column, wx), weights(y - row, wy);
  const auto across = [&](int r) {
    const double* p = &nodes_[std::size_t(r) * columns_ + std::size_t(column - 1)];
    return wx[0] * p[0] + wx[1] * p[1] + wx[2] * p[2] + wx[3] * p[3];
  };
  if (isotropic_) return across(0);
  double sum = 0;
  for (int k = 0; k < 4; ++k) sum += wy[k] * across(row - 1 + k);
  return sum;
}

double OverlappingScatterers::eval(double ux, double uy, double independent) const {
  return std::max(growth_ * independent + edge(ux, uy), 0.0);
}

double OverlappingScatterers::total() const {
  return 2 * kPi * std::expm1(density_ * mean_square_) / density_;
}

}  // namespace aureole::optics
