// SPDX-License-Identifier: Apache-2.0
#include "aureole/spectrum/wavelengths.h"

#include <algorithm>
#include <cmath>

#include "aureole/core/error.h"

namespace aureole {

SpectralGrid SpectralGrid::over(double min_nm, double max_nm) {
  if (!(min_nm > 0) || !(max_nm > min_nm) || !std::isfinite(max_nm))
    throw Error("a wavelength range must be 0 < min < max");
  // Number of cells: wide ranges get wider cells; narrow ranges (a laser line) still get enough cells to
  // resolve a shape.
  const double width = max_nm - min_nm;
  return {min_nm, max_nm, int(std::clamp(std::ceil(width), 64.0, 2000.0))};
}

Wavelengths Wavelengths::at(const SpectralGrid& grid, const Spectrum& nm, float pdf_per_nm) {
  Wavelengths w;
  w.nm = nm;
  w.pdf = pdf_per_nm;
  // Minimum and step as two floats each, so that the fraction stays precise over up to 2000 cells.
  const float minimum = float(grid.min_nm), step = float(grid.step()), inverse = float(1 / grid.step());
  const Spectrum from_first = (nm - minimum) - float(grid.min_nm - minimum);
  const Spectrum inside = min(max(from_first * inverse, 0.f), float(grid.cells - 1));
  w.cell = __builtin_convertvector(inside.v, SpectrumMask);
  const Spectrum cell = __builtin_convertvector(w.cell, SpectrumVector);
  const Spectrum rest = make_spectrum([&](int i) { return std::fma(-cell[i], step, from_first[i]); }) -
                        cell * float(grid.step() - step);
  w.fraction = min(max(rest * inverse, 0.f), 1.f);
  return w;
}

SampledSpectrum::SampledSpectrum(const SpectralGrid& grid, std::vector<float> node_values)
    : grid_(grid), table_(std::move(node_values)) {
  if (int(table_.size()) != grid.cells + 1) throw std::logic_error("SampledSpectrum: wrong number of nodes");
}

SampledSpectrum SampledSpectrum::constant(const SpectralGrid& grid, float value) {
  return {grid, std::vector<float>(grid.cells + 1, value)};
}

SampledSpectrum SampledSpectrum::from_points(const SpectralGrid& grid, std::span<const double> nm,
                                             std::span<const double> values, SpectrumEnds ends) {
  if (ends == SpectrumEnds::held && (nm.front() > grid.min_nm || nm.back() < grid.max_nm)) {
    std::vector<double> more_nm(nm.begin(), nm.end()), more_values(values.begin(), values.end());
    if (nm.front() > grid.min_nm)
      more_nm.insert(more_nm.begin(), grid.min_nm), more_values.insert(more_values.begin(), values.front());
    if (nm.back() < grid.max_nm) more_nm.push_back(grid.max_nm), more_values.push_back(values.back());
    return from_points(grid, more_nm, more_values);
  }
  // integral of s hat_i for each node i, with the hat function of the node, in units of a cell
  std::vector<double> moments(grid.cells + 1, 0.0);
  const double h = grid.step();
  for (size_t k = 0; k + 1 < nm.size(); ++k) {
    // The interval is clipped to the grid and integrated cell by cell. Both s and the hat function are linear
    // there, so that Simpson's rule is exact.
    const double a = std::max(nm[k], grid.min_nm), b = std::min(nm[k + 1], grid.max_nm);
    if (!(b > a)) continue;
    const double slope = (values[k + 1] - values[k]) / (nm[k + 1] - nm[k]);
    const auto s = [&](double x) { return values[k] + slope * (x - nm[k]); };
    const int first = std::clamp(int((a - grid.min_nm) / h), 0, grid.cells - 1);
    for (int c = first; c < grid.cells; ++c) {
      const double lo = std::max(a, grid.node(c)), hi = std::min(b, grid.node(c + 1));
      if (lo >= b) break;
      if (!(hi > lo)) continue;
      const double mid = 0.5 * (lo + hi), w = (hi - lo) / (6 * h);
      const auto right = [&](double x) { return (x - grid.node(c)) / h; };
      const double to_right = w * (s(lo) * right(lo) + 4 * s(mid) * right(mid) + s(hi) * right(hi));
      const double all = w * (s(lo) + 4 * s(mid) + s(hi));
      moments[c] += all - to_right;
      moments[c + 1] += to_right;
    }
  }
  std::vector<float> nodes(grid.cells + 1);
  for (int i = 0; i <= grid.cells; ++i)
    nodes[i] = float(moments[i] / (i == 0 || i == grid.cells ? 0.5 : 1.0));
  return {grid, std::move(nodes)};
}

SampledSpectrum SampledSpectrum::from_function(const SpectralGrid& grid,
                                               const std::function<double(double)>& f) {
  std::vector<float> nodes(grid.cells + 1);
  for (int i = 0; i <= grid.cells; ++i) nodes[i] = float(f(grid.node(i)));
  return {grid, std::move(nodes)};
}

double SampledSpectrum::integral() const {
  double s = 0;
  for (size_t i = 0; i + 1 < table_.size(); ++i) s += 0.5 * (double(table_[i]) + table_[i + 1]);
  return s * grid_.step();
}

float SampledSpectrum::maximum() const { return *std::max_element(table_.begin(), table_.end()); }
float SampledSpectrum::minimum() const { return *std::min_element(table_.begin(), table_.end()); }

void SampledSpectrum::scale(float s) {
  for (float& x : table_) x *= s;
}

SampledSpectrum product(const SampledSpectrum& a, const SampledSpectrum& b) {
  std::vector<float> nodes(a.nodes().begin(), a.nodes().end());
  for (size_t i = 0; i < nodes.size(); ++i) nodes[i] *= b.nodes()[i];
  return {a.grid(), std::move(nodes)};
}

double overlap(const SampledSpectrum& a, const SampledSpectrum& b) {
  double s = 0;
  for (size_t i = 0; i < a.nodes().size(); ++i) s += double(a.nodes()[i]) * b.nodes()[i];
  return s * a.grid().step();
}

WavelengthDistribution::WavelengthDistribution(const SpectralGrid& grid,
                                               std::span<const SampledSpectrum> densities,
                                               std::span<const float> weights)
    : grid_(grid), inverse_cdf_(kPieces + 1), density_(kPieces) {
  constexpr double kUniform = 0.02;
  std::vector<double> cell(grid.cells, kUniform / grid.cells);
  double total_weight = 0;
  for (size_t k = 0; k < densities.size(); ++k)
    if (densities[k].integral() > 0) total_weight += weights[k];
  for (size_t k = 0; k < densities.size(); ++k) {
    const double integral = densities[k].integral();
    if (!(integral > 0)) continue;
    const auto nodes = densities[k].nodes();
    const double scale = (1 - kUniform) * weights[k] / total_weight * grid.step() / integral;
    for (int c = 0; c < grid.cells; ++c) cell[c] += scale * 0.5 * (double(nodes[c]) + nodes[c + 1]);
  }
  double total = 0;
  for (double c : cell) total += c;
  int c = 0;
  double below = 0, previous = grid.min_nm;
  inverse_cdf_[0] = float(grid.min_nm);
  for (int k = 1; k <= kPieces; ++k) {
    const double target = total * k / kPieces;
    while (c < grid.cells - 1 && below + cell[c] < target) below += cell[c++];
    const double nm = k == kPieces
                          ? grid.max_nm
                          : grid.node(c) + grid.step() * std::clamp((target - below) / cell[c], 0.0, 1.0);
    inverse_cdf_[k] = float(nm);
    density_[k - 1] = float(1 / (kPieces * (nm - previous)));
    previous = nm;
  }
}

Wavelengths WavelengthDistribution::sample(float u) const {
  Spectrum x = make_spectrum([](int j) { return float(j) / kWavelengths; }) + u;
  x = select(x.v >= 1.f, x - 1.f, x) * float(kPieces);
  const SpectrumMask piece = __builtin_convertvector(min(x, float(kPieces - 1)).v, SpectrumMask);
  const Spectrum fraction = x - Spectrum(__builtin_convertvector(piece, SpectrumVector));
  const Spectrum lower = make_spectrum([&](int j) { return inverse_cdf_[size_t(piece[j])]; });
  const Spectrum upper = make_spectrum([&](int j) { return inverse_cdf_[size_t(piece[j]) + 1]; });
  const Spectrum pdf = make_spectrum([&](int j) { return density_[size_t(piece[j])]; });
  Wavelengths w = Wavelengths::at(grid_, lower + (upper - lower) * fraction);
  w.pdf = pdf;
  return w;
}

float WavelengthDistribution::pdf(float nm) const {
  if (!(nm >= grid_.min_nm && nm <= grid_.max_nm)) return 0;
  const auto it = std::upper_bound(inverse_cdf_.begin(), inverse_cdf_.end(), nm);
  const size_t k = std::clamp<size_t>(size_t(it - inverse_cdf_.begin()), 1, kPieces);
  return density_[k - 1];
}

}  // namespace aureole
