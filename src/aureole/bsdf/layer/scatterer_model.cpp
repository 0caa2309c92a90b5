// SPDX-License-Identifier: Apache-2.0
#include "aureole/bsdf/layer/scatterer_model.h"

#include <algorithm>
#include <cmath>

#include "aureole/core/parallel.h"

namespace aureole {
namespace {

constexpr int kStructureEnd = 1024;  // end of the table in u, beyond which S' = 1 to 1e-4 or better
constexpr int kTotals = 128;
/// Largest step of the area fraction between tables of scatterers that overlap. g changes by a fifth over a step
/// of 0.7, mostly linearly; between nodes the error is below 1e-3 of its peak.
constexpr double kOverlapStep = 0.1;

double ratio(double area_fraction) { return area_fraction / (1 - area_fraction); }

}  // namespace

ScattererModel::ScattererModel(const optics::ScattererMixture& mixture, const Correlation& correlation,
                               double least, double most, double extent)
    : covered_per_fraction_(mixture.covered_per_fraction()),
      fill_(mixture.mean_squared_area() / mixture.mean_area()),
      has_isotropic_shapes_(mixture.is_isotropic()),
      // Nodes that are too close cannot be distinguished in single precision.
      least_(most - least < 1e-4 ? most : least),
      most_(most),
      may_overlap_(correlation.may_overlap()),
      degree_(correlation.degree()) {
  if (may_overlap_) {
    tabulate_overlapping(mixture, extent);
    return;
  }
  auto factor = correlation.structure_factor(most);
  if (!factor->is_isotropic()) {
    anisotropic_ = factor;
    tables_.push_back(std::make_shared<optics::ScattererTable>(mixture, extent, factor, for_ranges));
    // integral of U + C S' over the rings, by Simpson's rule, and of the tail c/u^3 beyond them
    double sum = 0;
    constexpr double kStep = 1.0 / 64;
    const int cells = int(table().product_end() / kStep);
    for (int i = 0; i <= cells; ++i)
      sum += (i == 0 || i == cells ? 1
              : i % 2              ? 4
                                   : 2) *
             i * kStep * double(table().product_ring(float(i * kStep)));
    sum *= kStep / 3;
    const double end = table().product_end();
    sum += double(table().product_ring(float(end))) * end * end;
    inverse_totals_ = {float(1 / sum)};
    return;
  }
  tables_.push_back(std::make_shared<optics::ScattererTable>(mixture, extent, nullptr, for_ranges));
  single_ = mixture.is_uniform();
  inverse_ = correlation.interpolates_inverse();
  const std::vector<double> nodes = varies() ? correlation.nodes(least_, most_) : std::vector<double>{most};
  for (double fa : nodes) {
    const auto s = fa == most ? factor : correlation.structure_factor(fa);
    structures_.emplace_back([&](double u) { return inverse_ ? 1 / s->eval(u) - 1 : s->eval(u) - 1; },
                             kStructureEnd, false);
    ratios_.push_back(float(ratio(fa)));
  }
  const int totals = varies() ? kTotals : 0;
  for (int i = 0; i <= totals; ++i) {
    State state = at(float(totals > 0 ? least_ + (most_ - least_) * i / totals : most_));
    double correlated;
    if (mixture.has_correlated_sizes())
      correlated = optics::correlation_power([&](double u) {
        return double(table().uncorrelated_ring().eval(float(u))) - mixture.independent_ring(u);
      });
    else
      correlated = optics::correlation_power([&](double u) {
        return double(table().coherent_ring().eval(float(u))) * (double(structure(state, float(u))) - 1);
      });
    inverse_totals_.push_back(float(1 / (mixture.total() + correlated)));
  }
}

void ScattererModel::tabulate_overlapping(const optics::ScattererMixture& shapes, double extent) {
  const int cells = varies() ? int(std::ceil((most_ - least_) / kOverlapStep)) : 0;
  for (int i = 0; i <= cells; ++i) {
    // Without scatterers no light is diffracted, but the normalised intensity g has a limit.
    const double fa = std::max(cells > 0 ? std::lerp(least_, most_, double(i) / cells) : most_, 1e-6);
    const optics::ScattererMixture mixture = shapes.overlapping(fa, for_ranges);
    tables_.push_back(std::make_shared<optics::ScattererTable>(mixture, extent, nullptr, for_ranges));
    inverse_totals_.push_back(float(1 / mixture.total()));
  }
}

ScattererModel::State ScattererModel::at(float area_fraction) const {
  State s{};
  s.area_fraction = area_fraction;
  if (!varies()) {
    s.weights[0] = 1;
    s.inverse_total = inverse_totals_.empty() ? 0 : inverse_totals_[0];
    return s;
  }
  const float fa = std::clamp(area_fraction, float(least_), float(most_)), x = fa / (1 - fa);
  if (may_overlap_) {
    const int cells = tables() - 1;
    const float place = float((fa - least_) / (most_ - least_)) * float(cells);
    s.first = std::min(int(place), cells - 1), s.count = 2;
    const float t = place - float(s.first);
    const float a = (1 - t) * inverse_totals_[std::size_t(s.first)],
                b = t * inverse_totals_[std::size_t(s.first) + 1];
    s.inverse_total = a + b;
    s.weights[0] = a / s.inverse_total, s.weights[1] = b / s.inverse_total;
    return s;
  }
  const int groups = (int(ratios_.size()) - 1) / degree_;
  int group = 0;
  while (group + 1 < groups && x > ratios_[std::size_t(group + 1) * degree_]) ++group;
  s.first = group * degree_, s.count = degree_ + 1;
  for (int i = 0; i < s.count; ++i) {  // weights by Lagrange polynomials
    float w = 1;
    for (int j = 0; j < s.count; ++j)
      if (j != i) w *= (x - ratios_[s.first + j]) / (ratios_[s.first + i] - ratios_[s.first + j]);
    s.weights[i] = w;
  }
  if (inverse_totals_.size() == kTotals + 1) {
    const float place = float((fa - least_) / (most_ - least_)) * kTotals;
    const int i = std::clamp(int(place), 0, kTotals - 1);
    s.inverse_total = inverse_totals_[i] + (place - float(i)) * (inverse_totals_[i + 1] - inverse_totals_[i]);
  }
  return s;
}

float ScattererModel::covered(float area_fraction) const {
  const double fr = area_fraction * covered_per_fraction_;
  return float(may_overlap_ ? -std::expm1(-fr) : fr);
}

float ScattererModel::diffracted(float area_fraction) const {
  const double fr = area_fraction * covered_per_fraction_;
  return float(may_overlap_ ? std::exp(-2 * fr) * std::expm1(fr * fill_)
                            : std::max(fr * fill_ - fr * fr, 0.0));
}

Spectrum ScattererModel::parts(const optics::ScattererTable& table, const DiffractedWave& u,
                               Spectrum& coherent) const {
  Spectrum uncorrelated(0.f);
  if (!is_isotropic() && !(is_anisotropic() && has_isotropic_shapes_)) {
    table.eval<kWavelengths>(u.x.data(), u.y.data(), u.length.data(), uncorrelated.data(), coherent.data());
  } else {
    coherent = make_spectrum([&](int j) { return table.coherent_ring().eval(u.length[j]); });
    if (!single_)
      uncorrelated = make_spectrum([&](int j) { return table.uncorrelated_ring().eval(u.length[j]); });
  }
  return uncorrelated;
}

Spectrum ScattererModel::intensity(const State& state, const DiffractedWave& u) const {
  Spectrum coherent;
  if (may_overlap_) {
    Spectrum sum(0.f);
    for (int i = 0; i < state.count; ++i)
      sum += parts(table(state.first + i), u, coherent) * state.weights[std::size_t(i)];
    return max(sum * state.inverse_total, 0.f);
  }
  const Spectrum uncorrelated = parts(table(), u, coherent);
  Spectrum s;
  if (anisotropic_) {
    s = make_spectrum([&](int j) { return float(anisotropic_->eval(u.x[j], u.y[j])); });
  } else {
    s = structure(state, u.length);
  }
  return max((uncorrelated + coherent * s) * state.inverse_total, 0.f);
}

std::size_t ScattererModel::bytes() const {
  std::size_t sum = 0;
  for (const auto& t : tables_) sum += t->bytes();
  for (const auto& s : structures_) sum += s.bytes();
  return sum;
}

}  // namespace aureole
