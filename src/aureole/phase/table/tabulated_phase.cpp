// SPDX-License-Identifier: Apache-2.0
#include "aureole/phase/table/tabulated_phase.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "aureole/phase/lobe/deflection.h"

namespace aureole {

namespace {

void check(std::span<const double> mu, std::span<const double> nm, std::span<const double> values) {
  const auto increases = [](std::span<const double> v) {
    return std::adjacent_find(v.begin(), v.end(), [](double a, double b) { return !(a < b); }) == v.end();
  };
  if (mu.size() < 2 || mu.front() != -1 || mu.back() != 1 || !increases(mu))
    throw std::logic_error("cosines of a phase function run from -1 to 1");
  if (nm.empty() || !increases(nm) || values.size() != mu.size() * nm.size())
    throw std::logic_error("a phase function has one value per cosine and wavelength");
  for (const double v : values)
    if (!(v >= 0 && std::isfinite(v)))
      throw std::domain_error("a value of a phase function must not be negative, got " + std::to_string(v));
}

struct Rows {
  std::vector<double> x, values;
};

/// Returns the hemisphere around the forward or backward direction, ordered from its pole to 90 degrees. A
/// row at 90 degrees is interpolated if there is none.
Rows half_of(std::span<const double> mu, std::span<const double> values, std::size_t columns, bool forward) {
  Rows rows;
  const std::size_t n = mu.size();
  const auto index = [&](std::size_t i) { return forward ? n - 1 - i : i; };
  const auto row = [&](std::size_t i) { return values.subspan(index(i) * columns, columns); };
  for (std::size_t i = 0; i < n; ++i) {
    const double at = forward ? 1 - mu[index(i)] : 1 + mu[index(i)];
    // Nodes that are equal in single precision are skipped, since they would make empty cells.
    if (i > 0 && !(float(at) > float(rows.x.back()))) continue;
    if (float(at) < 1) {
      rows.x.push_back(at);
      rows.values.insert(rows.values.end(), row(i).begin(), row(i).end());
      continue;
    }
    const double before = rows.x.back(), share = std::min((1 - before) / (at - before), 1.0);
    const std::vector<double> last(rows.values.end() - std::ptrdiff_t(columns), rows.values.end());
    rows.x.push_back(1);
    for (std::size_t c = 0; c < columns; ++c) rows.values.push_back(last[c] + share * (row(i)[c] - last[c]));
    break;
  }
  return rows;
}

}  // namespace

TabulatedPhase::TabulatedPhase(std::span<const double> mu, std::span<const double> nm,
                               std::span<const double> values, const SpectralGrid& grid)
    : wavelengths_(int(nm.size())) {
  check(mu, nm, values);
  const std::size_t columns = nm.size();
  const Rows f = half_of(mu, values, columns, true), b = half_of(mu, values, columns, false);
  forward_ = HemisphereTable(f.x, f.values, columns);
  backward_ = HemisphereTable(b.x, b.values, columns);
  for (int c = 0; c < wavelengths_; ++c) {
    const double all = forward_.integral(c) + backward_.integral(c);
    if (!(all > 0)) throw std::domain_error("a phase function must not be zero at all angles");
    forward_.scale(c, 1 / all), backward_.scale(c, 1 / all);
  }
  forward_.prepare_samples(), backward_.prepare_samples();
  position_ = SampledSpectrum::from_function(grid, [&](double at) {
    const auto next = std::upper_bound(nm.begin(), nm.end(), at);
    if (next == nm.begin()) return 0.0;
    if (next == nm.end()) return double(columns - 1);
    return double(next - nm.begin() - 1) + (at - next[-1]) / (next[0] - next[-1]);
  });
}

Spectrum TabulatedPhase::eval_at(const HemisphereTable& half, const Place& place,
                                 const Wavelengths& w) const {
  if (wavelengths_ == 1) return half.eval(place, 0);
  const Spectrum position = position_.eval(w);
  int at[kWavelengths];
  for (int j = 0; j < kWavelengths; ++j) at[j] = std::min(int(position[j]), wavelengths_ - 2);
  return half.eval(place, at, position - make_spectrum([&](int j) { return float(at[j]); }));
}

Spectrum TabulatedPhase::eval(const Vec3& wi, const Vec3& wo, const Wavelengths& w) const {
  const float front = one_minus_cos(wi, wo), back = one_plus_cos(wi, wo);
  return front <= back ? eval_at(forward_, forward_.find(front), w)
                       : eval_at(backward_, backward_.find(back), w);
}

TabulatedPhase::Sample TabulatedPhase::sample(const Vec3& wi, float u1, Vec2 u2, const Wavelengths& w) const {
  int column = 0;
  if (wavelengths_ > 1) {
    const float position = position_.eval(w)[0];
    column = std::min(int(position), wavelengths_ - 2);
    if (u1 < position - float(column)) ++column;
  }
  const float ahead = float(forward_.integral(column));
  const bool is_ahead = u2.x < ahead || !(backward_.integral(column) > 0);
  const HemisphereTable& half = is_ahead ? forward_ : backward_;
  const Place place = half.sample(column, is_ahead ? u2.x : 1 - u2.x);
  return {turn_from(is_ahead ? -wi : wi, half.x(place), u2.y), eval_at(half, place, w)};
}

double TabulatedPhase::asymmetry(int node) const {
  return forward_.integral(node) - forward_.first_moment(node) - backward_.integral(node) +
         backward_.first_moment(node);
}

}  // namespace aureole
