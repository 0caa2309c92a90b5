// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/particle/phase_table.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>
#include <string>

#include "aureole/optics/constants.h"

namespace aureole::optics {
namespace {

/// Visits the integrals over the sphere between neighbouring nodes.
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
  // Three Gauss nodes in each step are exact for the product, whose degree is at most 4.
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
  // Root of the quadratic cumulative distribution, in the form without cancellation.
  const double a = p[i - 1], b = p[i], root = std::sqrt(std::max(0.0, a * a + share * (b * b - a * a)));
  const double t = a + root > 0 ? share * (a + b) / (a + root) : share;
  return mu[i - 1] + std::clamp(t, 0.0, 1.0) * width;
}

PhaseTables tabulate_phases(const PhaseEvaluator& evaluate, std::size_t count, double peak, double step,
                            const PhaseAccuracy& accuracy) {
  // Columns are indexed by the angle from the nearer pole, which serves both hemispheres.
  struct Column {
    std::vector<double> front, back;
    bool is_node = false;  // whether the column is a node; otherwise it is the evaluated midpoint of a step
  };
  std::map<double, Column> columns;
  std::vector<std::vector<double>> at(count), mirrored(count);
  const auto find = [&](const std::set<double>& angles) {
    std::vector<double> mu;
    for (const double angle : angles) mu.push_back(std::max(0.0, std::cos(angle)));
    for (auto* values : {&at, &mirrored})
      for (auto& row : *values) row.assign(mu.size(), 0);
    evaluate(mu, at, mirrored);
    std::size_t i = 0;
    for (const double angle : angles) {
      Column& column = columns[angle];
      for (std::size_t f = 0; f < count; ++f) {
        for (const double value : {at[f][i], mirrored[f][i]})
          if (!(value >= 0 && std::isfinite(value)))
            throw std::domain_error("phase function must not be negative, got " + std::to_string(value) +
                                    " at mu = " + std::to_string(mu[i]));
        column.front.push_back(at[f][i]), column.back.push_back(mirrored[f][i]);
      }
      ++i;
    }
  };
  const auto table_of = [&](std::size_t f) {
    PhaseTable table;
    for (const auto& [angle, column] : columns)
      if (column.is_node) table.mu.push_back(-std::cos(angle)), table.p.push_back(column.back[f]);
    table.mu.back() = 0;
    for (auto i = std::next(columns.rbegin()); i != columns.rend(); ++i)
      if (i->second.is_node) table.mu.push_back(std::cos(i->first)), table.p.push_back(i->second.front[f]);
    return table;
  };

  struct Step {
    double low, high;
    double middle() const { return 0.5 * (low + high); }
  };
  std::vector<Step> open;
  double angle = 0;
  for (double width = peak; angle + 1.5 * width < kPi / 2; width = std::min(1.4 * width, step)) {
    open.push_back({angle, angle + width});
    angle += width;
  }
  open.push_back({angle, kPi / 2});

  PhaseTables result;
  std::size_t nodes = 0;
  while (!open.empty()) {
    std::set<double> wanted;
    for (const Step& s : open)
      for (const double a : {s.low, s.middle(), s.high})
        if (!columns.count(a)) wanted.insert(a);
    find(wanted);
    for (const Step& s : open) columns[s.low].is_node = columns[s.high].is_node = true;
    nodes = 0;
    for (const auto& c : columns) nodes += c.second.is_node ? 2 : 0;
    std::vector<double> floors;
    for (std::size_t f = 0; f < count; ++f)
      floors.push_back(accuracy.floor * table_of(f).integral() / (4 * kPi));
    std::vector<Step> next;
    for (const Step& s : open) {
      const Column &a = columns[s.low], &b = columns[s.high], &c = columns[s.middle()];
      // Fraction (cos(low) - cos(middle))/(cos(low) - cos(high)), without cancellation.
      const double quarter = 0.25 * (s.high - s.low),
                   t = std::sin(s.low + quarter) * std::sin(quarter) /
                       (std::sin(s.low + 2 * quarter) * std::sin(2 * quarter));
      double worst = 0;
      for (std::size_t f = 0; f < count; ++f) {
        const auto test = [&](double p, double q, double middle) {
          const double scale = std::max(middle, floors[f]);
          if (scale > 0) worst = std::max(worst, std::abs(p + t * (q - p) - middle) / scale);
        };
        test(a.front[f], b.front[f], c.front[f]);
        test(a.back[f], b.back[f], c.back[f]);
      }
      if (worst <= accuracy.relative || nodes > accuracy.most_nodes || s.high - s.low < 1e-9) {
        result.error = std::max(result.error, worst);
        continue;
      }
      // For a smooth function half of the step has a quarter of the error.
      if (worst <= 2 * accuracy.relative) {
        columns[s.middle()].is_node = true;
        result.error = std::max(result.error, worst / 2);
        continue;
      }
      // The error falls as the square of the step, which predicts the number of halvings.
      const int halvings = std::clamp(int(std::ceil(0.5 * std::log2(worst / (2 * accuracy.relative)))), 1, 4);
      std::vector<Step> pieces{s};
      for (int k = 0; k < halvings; ++k) {
        std::vector<Step> halves;
        for (const Step& whole : pieces)
          halves.push_back({whole.low, whole.middle()}), halves.push_back({whole.middle(), whole.high});
        pieces = std::move(halves);
      }
      next.insert(next.end(), pieces.begin(), pieces.end());
      nodes += 2 * (pieces.size() - 1);
    }
    open = std::move(next);
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
