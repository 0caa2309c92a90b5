// SPDX-License-Identifier: Apache-2.0
#include "aureole/bsdf/microfacet_energy.h"

#include <array>

#include "aureole/bsdf/fresnel.h"

namespace aureole {

namespace {

ScatteredEnergy operator+(const ScatteredEnergy& a, const ScatteredEnergy& b) {
  return {a.reflected + b.reflected, a.transmitted + b.transmitted};
}
ScatteredEnergy operator*(const ScatteredEnergy& a, double s) { return {a.reflected * s, a.transmitted * s}; }

double fraction(double x) { return x - std::floor(x); }
/// Folds the unit interval: what is not periodic becomes so, and the lattice rule keeps its second order.
double folded(double u) { return 1 - std::abs(2 * u - 1); }

/// The mean of f(i, u) over the unit square by a lattice of the golden ratio.
template <class F>
auto lattice_mean(int points, F&& f) {
  const auto at = [&](int i) {
    constexpr double kGolden = 0.6180339887498949;
    return f(i, Vec2{float(folded((i + 0.5) / points)), float(folded(fraction(0.5 + i * kGolden)))});
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
  return lattice_mean(points, [&](int, Vec2 u) { return scatter(d, wi, eta, u); });
}

double mirrored_energy(const Microfacets& d, const Vec3& wi, int points) {
  return lattice_mean(points, [&](int, Vec2 u) {
    const Vec3 m = d.sample_visible(wi, u);
    return double(mirrored(d, wi, m, dot(wi, m)));
  });
}

double diffuse_scattered_reflectance(const Microfacets& d, float eta) {
  // Uniform in mu^2, the density 2 mu: a third dimension of the lattice, so that no line of it meets the
  // critical angle at one place.
  constexpr int kStrata = 64;
  double sum = 0;
  for (int k = 0; k < kStrata; ++k)
    sum += lattice_mean(610, [&](int i, Vec2 u) {
      const float mu2 = (float(k) + float(fraction(0.5 + i * 0.7548776662466927))) / kStrata;
      const float phi = 0.7f * float(k);  // for anisotropic surfaces
      const float r = std::sqrt(1 - mu2);
      return scatter(d, {r * std::cos(phi), r * std::sin(phi), std::sqrt(mu2)}, eta, u).reflected;
    });
  return sum / kStrata;
}

LossTable::LossTable(const Roughness& roughness, std::vector<float> etas, const Energy& energy)
    : isotropic_(roughness.is_isotropic()), etas_(std::move(etas)) {
  const auto axis = [&](Vec2 range, int most) {
    Axis a{range.x, range.y - range.x, 1};
    if (a.range > 0) a.nodes = most;
    return a;
  };
  u_ = axis(roughness.range_u(), isotropic_ ? 16 : 8);
  if (!isotropic_) v_ = axis(roughness.range_v(), 8), azimuths_ = 8;
  rows_ = u_.nodes * v_.nodes;
  if (etas_.size() > 1) inverse_step_ = 1 / (etas_[1] - etas_[0]);

  std::vector<Microfacets> rows;
  for (int i = 0; i < u_.nodes; ++i)
    for (int j = 0; j < v_.nodes; ++j)
      rows.emplace_back(roughness.type(), u_.node(i), isotropic_ ? u_.node(i) : v_.node(j));
  loss_.reserve(etas_.size() * rows.size() * std::size_t(azimuths_) * kCosines);
  for (const float eta : etas_)
    for (const Microfacets& d : rows)
      for (int a = 0; a < azimuths_; ++a) {
        // The azimuth at which the roughness is this node.
        const float u2 = d.alpha_u() * d.alpha_u(), v2 = d.alpha_v() * d.alpha_v();
        const float smaller = std::min(d.alpha_u(), d.alpha_v()), larger = std::max(d.alpha_u(), d.alpha_v());
        const float alpha =
            azimuths_ > 1 ? smaller + (larger - smaller) * float(a) / float(azimuths_ - 1) : 0;
        const float x2 = u2 != v2 ? std::clamp((alpha * alpha - v2) / (u2 - v2), 0.f, 1.f) : 1;
        for (int c = 0; c < kCosines; ++c) {
          const float t = float(c) / (kCosines - 1), mu = std::max(t * t, 1e-5f),
                      r = std::sqrt((1 - mu) * (1 + mu));
          const Vec3 w{r * std::sqrt(x2), r * std::sqrt(1 - x2), mu};
          loss_.push_back(float(std::max(1 - energy(d, w, eta), 0.0)));
        }
      }
  tabulate_averages(rows);
}

/// The averages are those of the interpolated table, so that what is added integrates to what is lost.
void LossTable::tabulate_averages(const std::vector<Microfacets>& rows) {
  std::array<double, kCosines> weights{};  // of the cosine's nodes: integral of 2 mu dmu = 4 t^3 dt
  const double h = 1.0 / (kCosines - 1);
  for (int c = 0; c + 1 < kCosines; ++c) {
    const double a = c * h, b = a + h;
    const double m3 = std::pow(b, 4) - std::pow(a, 4), m4 = 0.8 * (std::pow(b, 5) - std::pow(a, 5));
    weights[std::size_t(c + 1)] += (m4 - a * m3) / h;
    weights[std::size_t(c)] += (b * m3 - m4) / h;
  }
  average_.assign(etas_.size() * rows.size(), 0.f);
  for (std::size_t k = 0; k < average_.size(); ++k) {
    const Place place = locate(rows[k % rows.size()]);
    constexpr int kAzimuths = 256;
    double sum = 0;
    for (int i = 0; i < (azimuths_ > 1 ? kAzimuths : 1); ++i) {
      const float phi = 0.5f * kPi * (float(i) + 0.5f) / kAzimuths;
      const Cell azimuth = azimuths_ > 1 ? azimuth_cell(place, {std::cos(phi), std::sin(phi), 0}) : Cell{};
      for (int c = 0; c < kCosines; ++c) {
        const float* at =
            &loss_[(k * std::size_t(azimuths_) + std::size_t(azimuth.index)) * kCosines + std::size_t(c)];
        const double value = azimuths_ > 1 ? at[0] + (at[kCosines] - at[0]) * azimuth.fraction : at[0];
        sum += weights[std::size_t(c)] * value;
      }
    }
    average_[k] = float(azimuths_ > 1 ? sum / kAzimuths : sum);
  }
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
