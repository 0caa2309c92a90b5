// SPDX-License-Identifier: Apache-2.0
#include "aureole/bsdf/layer/scatterer_sampler.h"

#include <algorithm>
#include <cmath>

#include "aureole/bsdf/nested/nested_bsdfs.h"
#include "aureole/core/parallel.h"
#include "aureole/math/warp.h"

namespace aureole {

namespace {

/// Returns true with probability p; xi is then uniform in [0, 1) again.
bool choose(float& xi, float p) {
  const bool yes = xi < p;
  xi = yes ? remap_below(xi, p) : remap_above(xi, p);
  return yes;
}

/// Returns 1/power, or 0 if no power lies below u_max, as for a lattice finer than the wavelength.
float inverse(double power) { return power > 0 ? float(1 / power) : 0; }

}  // namespace

FractionNodes::FractionNodes(const ScattererModel& model) : least_(float(model.least())), rate_(0) {
  if (!model.varies()) {
    states_.push_back(model.at(least_));
    return;
  }
  constexpr double kStep = 1.0 / 40;
  const int cells = model.tables() > 1 ? model.tables() - 1
                                       : std::max(4, int(std::ceil((model.most() - model.least()) / kStep)));
  for (int i = 0; i <= cells; ++i)
    states_.push_back(model.at(float(model.least() + (model.most() - model.least()) * i / cells)));
  rate_ = float(cells / (model.most() - model.least()));
}

FractionNodes::Place FractionNodes::at(const ScattererModel::State& state) const {
  if (states_.size() == 1) return {0, 0};
  const float x = std::max((state.area_fraction - least_) * rate_, 0.f);
  const int i = std::min(int(x), count() - 2);
  return {i, std::min(x - float(i), 1.f)};
}

ProductSampler::ProductSampler(std::shared_ptr<const ScattererModel> model, bool correlated)
    : model_(std::move(model)), correlated_(correlated), nodes_(*model_) {
  for (int node = 0; node < (correlated ? nodes_.count() : 1); ++node) {
    const optics::ScattererTable& table = model_->table(node);
    const bool product = correlated && table.is_product();
    const int end = product ? int(table.product_end()) : table.end();
    const auto ring = [&](double u) {
      if (product) return double(table.product_ring(float(u)));
      const auto p = table.ring(float(u));
      return double(p.uncorrelated) + double(p.coherent) * double(structure(node, float(u)));
    };
    // Beyond `end` a ring falls as u^-3, and u times the ring as u^-2.
    radial_.emplace_back([&](double u) { return u * ring(u); }, end, ring(end) * std::pow(end, 3));
  }
}

Spectrum ProductSampler::azimuth(int node, const DiffractedWave& u) const {
  const optics::ScattererTable& table = model_->table(node);
  if (table.is_product() && !correlated_) return 1.f;
  const auto bins = table.coherent_azimuths().bins<kWavelengths>(u.x.data(), u.y.data(), u.length.data());
  const Spectrum scale = make_spectrum([&](int j) { return bins.scale[j]; });
  const auto of = [&](const optics::RingAzimuths& a) {
    return make_spectrum([&](int j) { return a.mass(bins.index[j]); }) * scale;
  };
  if (table.is_product() || model_->is_single()) return of(table.coherent_azimuths());
  const Spectrum uncorrelated =
      make_spectrum([&](int j) { return table.uncorrelated_ring().eval(u.length[j]); });
  Spectrum coherent = make_spectrum([&](int j) { return table.coherent_ring().eval(u.length[j]); });
  if (correlated_) coherent *= model_->structure(nodes_.state(node), u.length);
  // The choice is consistent with `sample`: where both terms are 0, C is chosen.
  const Spectrum sum = uncorrelated + coherent;
  const SpectrumMask positive = sum.v > Spectrum(0.f).v;
  const Spectrum share = select(positive, coherent / select(positive, sum, 1.f), 1.f);
  return of(table.coherent_azimuths()) * share + of(table.uncorrelated_azimuths()) * (Spectrum(1.f) - share);
}

ScattererSampler::Wave ProductSampler::sample(const ScattererModel::State& state, float& xi, Vec2 u2,
                                              double u_max) const {
  int node = 0;
  if (radial_.size() > 1) {
    const auto place = nodes_.at(state);
    node = place.node + choose(xi, place.next);
  }
  const double u = radial_[node].sample(u2.x, u_max);
  const optics::ScattererTable& table = model_->table(node);
  if (!table.has_azimuths() || (table.is_product() && !correlated_)) {
    const Vec2 d = cos_sin_2pi(u2.y);
    return {u * d.x, u * d.y};
  }
  float cosine, sine;
  if (table.is_product()) {
    table.uncorrelated_azimuths().sample(float(u), u2.y, cosine, sine);
  } else {
    float share = 1;
    if (!model_->is_single()) {
      const auto p = table.ring(float(u));
      const float coherent = p.coherent * structure(node, float(u)), sum = p.uncorrelated + coherent;
      if (sum > 0) share = coherent / sum;
    }
    (choose(xi, share) ? table.coherent_azimuths() : table.uncorrelated_azimuths())
        .sample(float(u), u2.y, cosine, sine);
  }
  return {u * cosine, u * sine};
}

Spectrum ProductSampler::density(const ScattererModel::State& state, const DiffractedWave& u,
                                 const Spectrum& u_max) const {
  const auto of_node = [&](int node) {
    const optics::RadialDistribution& r = radial_[std::size_t(node)];
    Spectrum d = make_spectrum([&](int j) { return r.eval(u.length[j]); });
    d *= make_spectrum([&](int j) { return inverse(r.cdf(u_max[j])); });
    if (model_->table().has_azimuths()) d *= azimuth(node, u);
    return d;
  };
  const auto place = radial_.size() > 1 ? nodes_.at(state) : FractionNodes::Place{0, 0};
  const Spectrum d = of_node(place.node);
  return place.next > 0 ? lerp(d, of_node(place.node + 1), place.next) : d;
}

std::size_t ProductSampler::bytes() const {
  std::size_t sum = 0;
  for (const auto& r : radial_) sum += r.bytes();
  return sum;
}

double FactorSampler::Structure::power_to(double u) const {
  if (u >= kEnd) return power[kCells] + 0.5 * (u - kEnd) * (u + kEnd);
  const int i = int(u * kRate);
  const double t = u * kRate - i, a = nodes[i], b = nodes[i + 1];
  return power[i] + t * (a + 0.5 * t * (b - a)) / kRate;
}

double FactorSampler::Structure::sample(double xi, double u_max) const {
  const double target = xi * power_to(u_max);
  if (target >= power[kCells])
    return std::min(std::sqrt(2 * (target - power[kCells]) + double(kEnd) * kEnd), u_max);
  const int i = int(std::upper_bound(power.begin(), power.end(), target) - power.begin()) - 1;
  const double a = nodes[i], b = nodes[i + 1], rest = (target - power[i]) * kRate;
  const double denominator = a + std::sqrt(std::max(0.0, a * a + 2 * (b - a) * rest));
  return std::min((i + (denominator > 0 ? std::min(2 * rest / denominator, 1.0) : 0.0)) / kRate, u_max);
}

float FactorSampler::Structure::eval(float u) const {
  if (!(u < kEnd)) return 1;
  u = std::max(u, 1e-15f);
  const float position = u * kRate;
  const int i = int(position);
  return (nodes[i] + (position - float(i)) * (nodes[i + 1] - nodes[i])) / u;
}

FactorSampler::FactorSampler(std::shared_ptr<const ScattererModel> model)
    : shapes_(model, false), nodes_(*model) {
  for (int node = 0; node < nodes_.count(); ++node) {
    Structure s{std::vector<float>(kCells + 1), std::vector<double>(kCells + 1)};
    for (int i = 0; i <= kCells; ++i) {
      const double u = double(i) / kRate;
      s.nodes[i] =
          float(u * double(model->is_anisotropic() ? 1 : model->structure(nodes_.state(node), float(u))));
      if (i > 0) s.power[i] = s.power[i - 1] + 0.5 * (double(s.nodes[i - 1]) + double(s.nodes[i])) / kRate;
    }
    structures_.push_back(std::move(s));
  }
}

ScattererSampler::Wave FactorSampler::sample(const ScattererModel::State& state, float& xi, Vec2 u2,
                                             double u_max) const {
  if (choose(xi, 0.5f)) return shapes_.sample(state, xi, u2, u_max);
  const auto place = nodes_.at(state);
  const double u = structures_[place.node + choose(xi, place.next)].sample(u2.x, u_max);
  const Vec2 d = cos_sin_2pi(u2.y);
  return {u * d.x, u * d.y};
}

Spectrum FactorSampler::density(const ScattererModel::State& state, const DiffractedWave& u,
                                const Spectrum& u_max) const {
  const auto place = nodes_.at(state);
  const auto of_node = [&](int node) {
    const Structure& s = structures_[std::size_t(node)];
    return make_spectrum([&](int j) { return s.eval(u.length[j]) * inverse(s.power_to(u_max[j])); });
  };
  Spectrum d = of_node(place.node);
  if (place.next > 0) d = lerp(d, of_node(place.node + 1), place.next);
  return (shapes_.density(state, u, u_max) + d) * 0.5f;
}

std::size_t FactorSampler::bytes() const {
  return shapes_.bytes() + structures_.size() * std::size_t(kCells + 1) * 12;
}

TableSampler::TableSampler(std::shared_ptr<const ScattererModel> model, double extent)
    : extent_(float(extent)) {
  const auto state = model->at(float(model->most()));
  std::vector<float> weights(std::size_t(kSize) * kSize);
  // Points in a row of a cell; a Spectrum holds kWavelengths of them at a time.
  constexpr int kAcross = 8;
  for_ranges(
      kSize,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row)
          for (int column = 0; column < kSize; ++column) {
            float sum = 0;
            for (int k = 0; k < kAcross; k += kWavelengths)
              for (int m = 0; m < 2; ++m) {
                DiffractedWave w;
                for (int j = 0; j < kWavelengths; ++j) {
                  const double x = (column + (k + j + 0.5) / kAcross) / kSize,
                               y = (double(row) + (m + 0.5) / 2) / kSize;
                  w.x[j] = float((2 * x - 1) * extent), w.y[j] = float((2 * y - 1) * extent);
                }
                w.length = sqrt(w.x * w.x + w.y * w.y);
                sum += aureole::sum(model->intensity(state, w));
              }
            weights[row * kSize + std::size_t(column)] = sum;
          }
      },
      8);
  // The sum gets a positive lower bound, so that peaks between the evaluated points are never missed.
  double total = 0;
  for (const float w : weights) total += double(w);
  for (float& w : weights) w += float(1e-3 * total / double(weights.size()));
  table_ = Piecewise2D(weights, kSize, kSize);
}

ScattererSampler::Wave TableSampler::sample(const ScattererModel::State&, float&, Vec2 u2, double) const {
  float pdf;
  const Vec2 p = table_.sample(u2, &pdf);
  return {double(2 * p.x - 1) * double(extent_), double(2 * p.y - 1) * double(extent_)};
}

Spectrum TableSampler::density(const ScattererModel::State&, const DiffractedWave& u, const Spectrum&) const {
  return make_spectrum([&](int j) {
    const Vec2 p{(u.x[j] / extent_ + 1) * 0.5f, (u.y[j] / extent_ + 1) * 0.5f};
    if (!(p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1)) return 0.f;
    return table_.pdf(p) * float(2 * M_PI) / (4 * extent_ * extent_);
  });
}

}  // namespace aureole
