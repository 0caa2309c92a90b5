// SPDX-License-Identifier: Apache-2.0
#include "aureole/bsdf/microfacet/microfacet_energy.h"

#include <array>
#include <atomic>

#include "aureole/core/parallel.h"
#include "aureole/math/warp.h"
#include "aureole/spectrum/fresnel.h"

namespace aureole {

namespace {

ScatteredEnergy operator+(const ScatteredEnergy& a, const ScatteredEnergy& b) {
  return {a.reflected + b.reflected, a.transmitted + b.transmitted};
}
ScatteredEnergy operator*(const ScatteredEnergy& a, double s) { return {a.reflected * s, a.transmitted * s}; }

double fraction(double x) { return x - std::floor(x); }
/// Folds the unit interval, which makes functions periodic, so that the lattice rule keeps its second order.
double folded(double u) { return 1 - std::abs(2 * u - 1); }

/// Returns the mean of f(i, u) over the unit square by a shifted golden-ratio lattice.
template <class F>
auto lattice_mean(int points, double shift, F&& f) {
  const auto at = [&](int i) {
    constexpr double kGolden = 0.6180339887498949;
    return f(i, Vec2{float(folded(fraction((i + 0.5) / points + shift))),
                     float(folded(fraction(0.5 + i * kGolden + 2 * shift)))});
  };
  auto sum = at(0);
  for (int i = 1; i < points; ++i) sum = sum + at(i);
  return sum * (1.0 / points);
}

float mirrored(const Microfacets& d, const Vec3& wi, const Vec3& m, float cos_im) {
  const Vec3 wo = 2 * cos_im * m - wi;
  return wo.z > 0 ? d.masking(wo) : 0;
}

ScatteredEnergy scatter(const Microfacets& d, const Vec3& wi, float eta, Vec2 u) {
  const Vec3 m = d.sample_visible(wi, u);
  const float cos_im = dot(wi, m);
  if (!(cos_im > 0)) return {};
  const DielectricFresnel f = fresnel_dielectric(cos_im, eta);
  ScatteredEnergy e{f.reflectance * mirrored(d, wi, m, cos_im), 0};
  const Vec3 down = m * (cos_im / eta - f.cos_t) - wi * (1 / eta);
  if (f.reflectance < 1 && down.z < 0) e.transmitted = (1 - f.reflectance) * d.masking(-down);
  return e;
}

}  // namespace

ScatteredEnergy scattered_energy(const Microfacets& d, const Vec3& wi, float eta, int points) {
  return lattice_mean(points, 0, [&](int, Vec2 u) { return scatter(d, wi, eta, u); });
}

double mirrored_energy(const Microfacets& d, const Vec3& wi, int points) {
  return lattice_mean(points, 0, [&](int, Vec2 u) {
    const Vec3 m = d.sample_visible(wi, u);
    return double(mirrored(d, wi, m, dot(wi, m)));
  });
}

ScatteredEnergy diffuse_scattered_energy(const Microfacets& d, float eta) {
  // The square of a cosine mu of density 2 mu is uniform. All strata have different lattices, so that
  // their errors, which the critical angle makes large, cancel.
  constexpr int kStrata = 64;
  const int points = d.type() == NormalDistribution::beckmann ? 610 : 1597;
  std::array<ScatteredEnergy, kStrata> strata;
  for_ranges(
      kStrata,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k)
          strata[k] = lattice_mean(points, double(k) * 0.7548776662466927, [&](int i, Vec2 u) {
            const float c2 = (float(k) + float(fraction(0.5 + i * 0.4142135623730950))) / kStrata,
                        r = std::sqrt(1 - c2);
            const Vec2 a = cos_sin_2pi(float(fraction(i * 0.5698402909980532)));
            return scatter(d, {r * a.x, r * a.y, std::sqrt(c2)}, eta, u);
          });
      },
      8);
  ScatteredEnergy sum;
  for (const ScatteredEnergy& stratum : strata) sum = sum + stratum;
  return sum * (1.0 / kStrata);
}

bool read_energy_preserving(const Properties& properties) {
  return properties.get_bool("energy_preserving", properties.context().energy_preserving.value_or(false));
}

bool states_energy_preserving(const Properties& properties) {
  return properties.has("energy_preserving") || properties.context().energy_preserving.has_value();
}

double DiffuseLoss::operator()(const Microfacets& d, float eta, bool from_within) const {
  std::atomic<float>& known = known_[from_within ? 1 : 0];
  if (known < 0) {
    const ScatteredEnergy kept = diffuse_scattered_energy(d, from_within ? 1 / eta : eta);
    known = std::max(float(1 - kept.reflected - kept.transmitted), 0.f);
  }
  return double(known.load());
}

LossTable::LossTable(const Roughness& roughness, std::vector<float> etas, const Energy& energy)
    : isotropic_(roughness.is_isotropic()), etas_(std::move(etas)) {
  const Vec2 u = roughness.range_u(), v = roughness.range_v();
  const bool u_varies = u.x < u.y, v_varies = !isotropic_ && v.x < v.y;
  const int nodes = u_varies && v_varies ? 6 : 12;
  u_ = {u.x, u.y - u.x, u_varies ? nodes : 1};
  if (!isotropic_) {
    v_ = {v.x, v.y - v.x, v_varies ? nodes : 1};
    azimuths_ = u_varies && v_varies ? 8 : u_varies || v_varies ? 12 : 24;
  }
  rows_ = u_.nodes * v_.nodes;
  if (etas_.size() > 1) inverse_step_ = 1 / (etas_[1] - etas_[0]);

  std::vector<Microfacets> rows;
  for (int i = 0; i < u_.nodes; ++i)
    for (int j = 0; j < v_.nodes; ++j)
      rows.emplace_back(roughness.type(), u_.node(i), isotropic_ ? u_.node(i) : v_.node(j));
  const int lines = int(etas_.size()) * rows_ * azimuths_;
  // fewer points for large tables, which may take a second of one core
  const int points = lines > 48 ? 377 : 987;
  loss_.resize(std::size_t(lines) * kCosines);
  std::atomic<int> next{0};
  run_workers(std::min(default_thread_count(), lines), [&](int) {
    for (int line; (line = next++) < lines;) {
      const Microfacets& d = rows[std::size_t(line / azimuths_ % rows_)];
      const float eta = etas_[std::size_t(line / azimuths_ / rows_)];
      const Vec2 azimuth = azimuth_of_node(d, line % azimuths_);
      for (int c = 0; c < kCosines; ++c) {
        const float t = float(c) / (kCosines - 1), mu = std::max(t * t, 1e-5f);
        const float r = std::sqrt((1 - mu) * (1 + mu));
        const double kept = energy(d, {r * azimuth.x, r * azimuth.y, mu}, eta, points);
        loss_[std::size_t(line * kCosines + c)] = float(std::max(1 - kept, 0.0));
      }
    }
  });
  tabulate_masses(rows);
}

/// Returns the azimuth, as cosine and sine, along which the roughness is that of a node.
Vec2 LossTable::azimuth_of_node(const Microfacets& d, int node) const {
  const float u2 = d.alpha_u() * d.alpha_u(), v2 = d.alpha_v() * d.alpha_v();
  if (azimuths_ == 1 || u2 == v2) return {1, 0};
  const float smaller = std::min(d.alpha_u(), d.alpha_v()), larger = std::max(d.alpha_u(), d.alpha_v());
  const float t = float(node) / float(azimuths_ - 1), alpha = smaller + (larger - smaller) * t * t;
  const float x2 = std::clamp((alpha * alpha - v2) / (u2 - v2), 0.f, 1.f);
  return {std::sqrt(x2), std::sqrt(1 - x2)};
}

/// Masses and averages are those of the interpolated table, so that the added light integrates to the lost
/// light.
void LossTable::tabulate_masses(const std::vector<Microfacets>& rows) {
  // For the two nodes of a cell of the cosine: integral of 2 mu dmu = 4 t^3 dt times a node's hat function.
  std::array<std::array<double, 2>, kCosines - 1> weights;
  const double h = 1.0 / (kCosines - 1);
  for (int c = 0; c + 1 < kCosines; ++c) {
    const double a = c * h, b = a + h;
    const double m3 = std::pow(b, 4) - std::pow(a, 4), m4 = 0.8 * (std::pow(b, 5) - std::pow(a, 5));
    weights[std::size_t(c)] = {(b * m3 - m4) / h, (m4 - a * m3) / h};
  }
  for (std::size_t k = 0; k < etas_.size() * rows.size(); ++k) {
    const Place place = locate(rows[k % rows.size()]);
    // Mean over the azimuths at each node.
    std::array<double, kCosines> mean{};
    const int count = azimuths_ > 1 ? 256 : 1;
    for (int i = 0; i < count; ++i) {
      const float phi = 0.5f * kPi * (float(i) + 0.5f) / float(count);
      const Cell azimuth = azimuths_ > 1 ? azimuth_cell(place, {std::cos(phi), std::sin(phi), 0}) : Cell{};
      const float* line = &loss_[(k * std::size_t(azimuths_) + std::size_t(azimuth.index)) * kCosines];
      for (int c = 0; c < kCosines; ++c) {
        const double next = azimuths_ > 1 ? line[kCosines + c] : 0;
        mean[std::size_t(c)] += (line[c] + (next - line[c]) * azimuth.fraction) / count;
      }
    }
    double sum = 0;
    mass_below_.push_back(0);
    for (std::size_t c = 0; c + 1 < kCosines; ++c) {
      sum += weights[c][0] * mean[c] + weights[c][1] * mean[c + 1];
      mass_below_.push_back(float(sum));
    }
  }
}

Vec3 LossTable::sample(const Place& place, float eta, Vec2 u) const {
  const auto mass = [&](int node) {
    return over_indices(eta, [&](int e) { return mass_below(place, e, node); });
  };
  const float target = u.x * mass(kCosines - 1);
  int low = 0, high = kCosines - 1;
  while (high - low > 1) {
    const int middle = (low + high) / 2;
    (mass(middle) <= target ? low : high) = middle;
  }
  // Position within a cell of the cosine.
  const float below = mass(low), part = mass(high) - below;
  const float through = part > 0 ? std::clamp((target - below) / part, 0.f, 1.f) : 0.5f;
  const float c2 = squared_cosine(low) + (squared_cosine(high) - squared_cosine(low)) * through;
  const float r = std::sqrt(1 - c2);
  const Vec2 a = cos_sin_2pi(u.y);
  return {r * a.x, r * a.y, std::max(std::sqrt(c2), 1e-6f)};
}

LossTable::Place LossTable::locate(const Microfacets& d) const {
  const Cell u = u_.locate(d.alpha_u()), v = isotropic_ ? Cell{} : v_.locate(d.alpha_v());
  Place p;
  for (int i = 0; i < std::min(u_.nodes, 2); ++i)
    for (int j = 0; j < std::min(v_.nodes, 2); ++j) {
      p.row[p.count] = (u.index + i) * v_.nodes + v.index + j;
      p.weight[p.count++] = (i              ? u.fraction
                             : u_.nodes > 1 ? 1 - u.fraction
                                            : 1) *
                            (j              ? v.fraction
                             : v_.nodes > 1 ? 1 - v.fraction
                                            : 1);
    }
  p.u2 = d.alpha_u() * d.alpha_u();
  p.v2 = d.alpha_v() * d.alpha_v();
  p.smaller = std::min(d.alpha_u(), d.alpha_v());
  const float span = std::max(d.alpha_u(), d.alpha_v()) - p.smaller;
  p.inverse_span = span > 0 ? 1 / span : 0;
  return p;
}

}  // namespace aureole
