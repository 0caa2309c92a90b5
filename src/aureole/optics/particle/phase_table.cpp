// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/particle/phase_table.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>
#include <string>

namespace aureole::optics {
namespace {

constexpr double kPi = std::numbers::pi;

/// Integrals over the sphere between neighbouring nodes.
template <class Visit>
void for_each_step(const PhaseTable& t, const Visit& visit) {
  for (std::size_t i = 0; i + 1 < t.mu.size(); ++i)
    visit(i, kPi * (t.p[i] + t.p[i + 1]) * (t.mu[i + 1] - t.mu[i]));
}

}  // namespace

double PhaseTable::eval(double at) const {
  at = std::clamp(at, -1.0, 1.0);
  const std::size_t i =
      std::clamp<std::size_t>(std::upper_bound(mu.begin(), mu.end(), at) - mu.begin(), 1, mu.size() - 1);
  const double t = (at - mu[i - 1]) / (mu[i] - mu[i - 1]);
  return p[i - 1] + t * (p[i] - p[i - 1]);
}

double PhaseTable::integral() const {
  double sum = 0;
  for_each_step(*this, [&](std::size_t, double mass) { sum += mass; });
  return sum;
}

double PhaseTable::legendre(int l) const {
  // Three Gauss nodes in each step are exact for the product, of degree 4 at most.
  const double at[] = {-std::sqrt(0.6), 0, std::sqrt(0.6)}, weight[] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
  double sum = 0, total = 0;
  for (std::size_t i = 0; i + 1 < mu.size(); ++i) {
    const double width = mu[i + 1] - mu[i];
    for (int k = 0; k < 3; ++k) {
      const double t = 0.5 * (1 + at[k]), x = mu[i] + t * width;
      const double value = weight[k] * width * (p[i] + t * (p[i + 1] - p[i]));
      total += value;
      sum += value * (l == 0 ? 1 : l == 1 ? x : l == 2 ? 0.5 * (3 * x * x - 1) : 0.5 * x * (5 * x * x - 3));
    }
  }
  return sum / total;
}

std::vector<double> PhaseTable::cdf() const {
  std::vector<double> sum(mu.size(), 0);
  for_each_step(*this, [&](std::size_t i, double mass) { sum[i + 1] = sum[i] + mass; });
  for (double& s : sum) s /= sum.back();
  return sum;
}

double PhaseTable::sample(std::span<const double> cdf, double u) const {
  const std::size_t i =
      std::clamp<std::size_t>(std::upper_bound(cdf.begin(), cdf.end(), u) - cdf.begin(), 1, mu.size() - 1);
  const double width = mu[i] - mu[i - 1], share = (u - cdf[i - 1]) / (cdf[i] - cdf[i - 1]);
  // The root of the quadratic cumulative density, in the form that does not cancel.
  const double a = p[i - 1], b = p[i], root = std::sqrt(std::max(0.0, a * a + share * (b * b - a * a)));
  const double t = a + root > 0 ? share * (a + b) / (a + root) : share;
  return mu[i - 1] + std::clamp(t, 0.0, 1.0) * width;
}

PhaseTables tabulate_phases(const PhaseEvaluator& evaluate, std::size_t count, double peak, double step,
                            const PhaseAccuracy& accuracy) {
  // By the angle from the nearer pole, which both halves share: values in front, then behind.
  struct Column {
    std::vector<double> front, back;
  };
  std::map<double, Column> columns;
  std::vector<std::vector<double>> at(count), mirrored(count);
  const auto find = [&](const std::vector<double>& angles) {
    std::vector<double> mu(angles.size());
    for (std::size_t i = 0; i < mu.size(); ++i) mu[i] = std::max(0.0, std::cos(angles[i]));
    for (auto* values : {&at, &mirrored})
      for (auto& row : *values) row.assign(mu.size(), 0);
    evaluate(mu, at, mirrored);
    std::vector<Column> found(mu.size());
    for (std::size_t i = 0; i < mu.size(); ++i)
      for (std::size_t f = 0; f < count; ++f) {
        for (const double value : {at[f][i], mirrored[f][i]})
          if (!(value >= 0 && std::isfinite(value)))
            throw std::domain_error("phase function must not be negative, got " + std::to_string(value) +
                                    " at mu = " + std::to_string(mu[i]));
        found[i].front.push_back(at[f][i]), found[i].back.push_back(mirrored[f][i]);
      }
    return found;
  };
  std::vector<double> angles{0};
  for (double width = peak; angles.back() + 1.5 * width < kPi / 2; width = std::min(1.4 * width, step))
    angles.push_back(angles.back() + width);
  angles.push_back(kPi / 2);
  auto first = find(angles);
  for (std::size_t i = 0; i < angles.size(); ++i) columns[angles[i]] = std::move(first[i]);

  const auto table_of = [&](std::size_t f) {
    PhaseTable table;
    for (const auto& [angle, column] : columns)
      table.mu.push_back(-std::cos(angle)), table.p.push_back(column.back[f]);
    table.mu.back() = 0;
    for (auto i = std::next(columns.rbegin()); i != columns.rend(); ++i)
      table.mu.push_back(std::cos(i->first)), table.p.push_back(i->second.front[f]);
    return table;
  };

  PhaseTables result;
  struct Split {
    double low, high;
    int pieces;
  };
  std::vector<std::pair<double, double>> open;
  for (std::size_t i = 0; i + 1 < angles.size(); ++i) open.push_back({angles[i], angles[i + 1]});
  while (!open.empty()) {
    std::vector<double> floors, middles;
    for (std::size_t f = 0; f < count; ++f)
      floors.push_back(accuracy.floor * table_of(f).integral() / (4 * kPi));
    for (const auto& [low, high] : open) middles.push_back(0.5 * (low + high));
    auto found = find(middles);
    const bool full = 2 * (columns.size() + open.size()) > accuracy.most_nodes;
    std::vector<Split> split;
    for (std::size_t i = 0; i < open.size(); ++i) {
      const auto [low, high] = open[i];
      const Column &a = columns[low], &b = columns[high];
      // cos(low) - cos(middle) over cos(low) - cos(high), without their cancellation.
      const double quarter = 0.25 * (high - low), t = std::sin(low + quarter) * std::sin(quarter) /
                                                      (std::sin(low + 2 * quarter) * std::sin(2 * quarter));
      double worst = 0;
      for (std::size_t f = 0; f < count; ++f) {
        const auto test = [&](double p, double q, double middle) {
          const double scale = std::max(middle, floors[f]);
          if (scale > 0) worst = std::max(worst, std::abs(p + t * (q - p) - middle) / scale);
        };
        test(a.front[f], b.front[f], found[i].front[f]);
        test(a.back[f], b.back[f], found[i].back[f]);
      }
      if (worst <= accuracy.relative || full || high - low < 1e-9) {
        result.error = std::max(result.error, worst);
      } else {
        // The error falls as the square of the step: this many halvings may do.
        const int halvings = std::clamp(int(std::ceil(0.5 * std::log2(worst / accuracy.relative))), 1, 4);
        columns[middles[i]] = std::move(found[i]);
        split.push_back({low, high, 1 << halvings});
      }
    }
    open.clear();
    std::vector<double> inner;
    for (const Split& s : split)
      for (int k = 1; k < s.pieces; ++k)
        if (2 * k != s.pieces) inner.push_back(s.low + k * ((s.high - s.low) / s.pieces));
    if (!inner.empty()) {
      auto more = find(inner);
      for (std::size_t i = 0; i < inner.size(); ++i) columns[inner[i]] = std::move(more[i]);
    }
    for (const Split& s : split)
      for (auto at_low = columns.find(s.low); at_low->first < s.high; ++at_low)
        open.push_back({at_low->first, std::next(at_low)->first});
  }
  for (std::size_t f = 0; f < count; ++f) {
    PhaseTable table = table_of(f);
    const double sum = table.integral();
    if (!(sum > 0)) throw std::domain_error("phase function has no mass");
    for (double& p : table.p) p /= sum;
    result.tables.push_back(std::move(table));
    result.integrals.push_back(sum);
  }
  return result;
}

}  // namespace aureole::optics
