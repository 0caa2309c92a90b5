// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/arrangement/structure_factor.h"

#include <algorithm>
#include <numbers>
#include <stdexcept>
#include <string>

#include "aureole/optics/aperture/aperture_transform.h"
#include "aureole/optics/arrangement/ring_mean.h"
#include "aureole/optics/bessel.h"

namespace aureole::optics {
namespace {

void check_percus_yevick(double area_fraction) {
  if (!(area_fraction >= 0 && area_fraction <= kMaxAreaFraction + kFractionTolerance))
    throw std::domain_error("area fraction of hard discs must be in [0, 0.7], got " +
                            std::to_string(area_fraction));
}

/// Returns the mean over the ring |q| = u of a function with S(-u) = S(u).
double mean_over_ring(const StructureFactor& s, double u) {
  return ring_mean(u, 64 + int(4 * u), [&](double x, double y) { return s.eval(x, y); });
}

}  // namespace

HardDiscWave::HardDiscWave(double u)
    : disc(circle_transform(u)), double_disc(circle_transform(2 * u)), j0(bessel_j0(std::abs(u))) {}

double HardDiscWave::structure_factor(double area_fraction) const {
  check_percus_yevick(area_fraction);
  const double ratio = area_fraction / (1 - area_fraction);
  // Direct correlation function: the first term is the exclusion of a disc of radius 2a; the other two are
  // the overlaps of edges and of areas.
  const double c = 4 * ratio * double_disc + 4 * ratio * ratio * j0 * disc +
                   (ratio * ratio + 2 * ratio * ratio * ratio) * disc * disc;
  return 1 / (1 + c);
}

double hard_disc_structure_factor(double u, double area_fraction) {
  return HardDiscWave(u).structure_factor(area_fraction);
}

PercusYevickStructureFactor::PercusYevickStructureFactor(double area_fraction)
    : area_fraction_(area_fraction) {
  check_percus_yevick(area_fraction);
}

TabulatedStructureFactor::TabulatedStructureFactor(std::vector<double> u, std::vector<double> values)
    : u_(std::move(u)), values_(std::move(values)) {
  if (u_.size() < 2) throw std::domain_error("a structure factor needs at least two values");
  for (std::size_t i = 0; i < u_.size(); ++i) {
    if (!(u_[i] >= 0 && std::isfinite(u_[i])) || (i > 0 && !(u_[i] > u_[i - 1])))
      throw std::domain_error("values of u must be positive and increase, but number " +
                              std::to_string(i + 1) + " is " + std::to_string(u_[i]));
    if (!(values_[i] >= 0 && std::isfinite(values_[i])))
      throw std::domain_error("a structure factor must not be negative, but at u = " + std::to_string(u_[i]) +
                              " it is " + std::to_string(values_[i]));
  }
}

double TabulatedStructureFactor::eval(double u) const {
  u = std::abs(u);
  if (u <= u_.front()) return values_.front();
  if (u >= u_.back()) return 1;
  const std::size_t i = std::size_t(std::upper_bound(u_.begin(), u_.end(), u) - u_.begin()) - 1;
  const double t = (u - u_[i]) / (u_[i + 1] - u_[i]);
  return values_[i] + t * (values_[i + 1] - values_[i]);
}

TabulatedStructureFactor TabulatedStructureFactor::from_pair_correlation(const std::vector<double>& r,
                                                                         const std::vector<double>& g,
                                                                         double area_fraction) {
  if (r.size() < 8) throw std::domain_error("a pair correlation needs at least 8 values");
  for (std::size_t i = 0; i < r.size(); ++i) {
    if (!(r[i] >= 0 && std::isfinite(r[i])) || (i > 0 && !(r[i] > r[i - 1])))
      throw std::domain_error("distances must be positive and increase, but number " + std::to_string(i + 1) +
                              " is " + std::to_string(r[i]));
    if (!(g[i] >= 0 && std::isfinite(g[i])))
      throw std::domain_error("a pair correlation must not be negative, but at r = " + std::to_string(r[i]) +
                              " it is " + std::to_string(g[i]));
  }
  const double end = r.back();
  if (!(end > 4))
    throw std::domain_error("a pair correlation must reach beyond r = 4 a, but ends at " +
                            std::to_string(end));
  const auto h = [&](double x) {
    if (x < r.front()) return -1.0;  // g(r) = 0: no pair is closer than the first distance of the table
    const std::size_t i =
        std::min(std::size_t(std::upper_bound(r.begin(), r.end(), x) - r.begin()), r.size() - 1) - 1;
    const double t = (x - r[i]) / (r[i + 1] - r[i]);
    // g - 1 is tapered to 0 over the second half of the range: truncation would leave ripples in S'.
    const double fade = x < end / 2 ? 1 : std::pow(std::cos(std::numbers::pi / 2 * (x / (end / 2) - 1)), 2);
    return (g[i] + t * (g[i + 1] - g[i]) - 1) * fade;
  };
  constexpr double kLargestDistance = 200;
  if (end > kLargestDistance)
    throw std::domain_error("a pair correlation to r = " + std::to_string(end) +
                            " correlation radii is too long, at most "
                            "200 are read: is the correlation radius that of the table's unit?");
  const int steps = std::max(1000, int(end * 48));
  std::vector<double> weights(steps), places(steps);
  const double step = end / steps;
  for (int i = 0; i < steps; ++i) {
    places[i] = (i + 0.5) * step;
    weights[i] = 2 * area_fraction * h(places[i]) * places[i] * step;  // weights with 2 pi rho0 a^2 = 2 Fa
  }
  std::vector<double> u, values;
  constexpr double kEnd = 60, kStep = 1.0 / 16;
  for (int k = 0; k * kStep <= kEnd; ++k) {
    double sum = 1;
    for (int i = 0; i < steps; ++i) sum += weights[i] * bessel_j0(k * kStep * places[i]);
    u.push_back(k * kStep), values.push_back(std::max(sum, 0.0));
  }
  return {std::move(u), std::move(values)};
}

MappedStructureFactor::MappedStructureFactor(std::vector<float> values, int width, int height, double extent)
    : values_(std::move(values)), width_(width), height_(height), extent_(extent) {
  const std::size_t n = values_.size();
  for (std::size_t i = 0; i < n; ++i)
    if (!(values_[i] >= 0 && std::isfinite(values_[i])))
      throw std::domain_error("a structure factor must not be negative, but pixel (" +
                              std::to_string(i % std::size_t(width)) + ", " +
                              std::to_string(i / std::size_t(width)) + ") is " + std::to_string(values_[i]));
  for (std::size_t i = 0; i < n / 2; ++i)  // the second half is the first one rotated by 180 degrees
    values_[i] = values_[n - 1 - i] = 0.5f * (values_[i] + values_[n - 1 - i]);
}

double MappedStructureFactor::eval(double u) const { return mean_over_ring(*this, u); }

double MappedStructureFactor::eval(double ux, double uy) const {
  if (!(std::abs(ux) <= extent_ && std::abs(uy) <= extent_)) return 1;
  const double x = std::clamp((ux / extent_ + 1) * 0.5 * width_ - 0.5, 0.0, width_ - 1.0),
               y = std::clamp((1 - uy / extent_) * 0.5 * height_ - 0.5, 0.0, height_ - 1.0);
  const int i = std::min(int(x), std::max(width_ - 2, 0)), j = std::min(int(y), std::max(height_ - 2, 0));
  const int right = std::min(i + 1, width_ - 1), below = std::min(j + 1, height_ - 1);
  const auto at = [&](int column, int row) { return double(values_[std::size_t(row) * width_ + column]); };
  const double s = x - i, t = y - j;
  return (at(i, j) * (1 - s) + at(right, j) * s) * (1 - t) +
         (at(i, below) * (1 - s) + at(right, below) * s) * t;
}

double LatticeStructureFactor::closest_packing(Kind kind) {
  return kind == Kind::hexagonal ? kClosestDiscPacking : std::numbers::pi / 4;
}

LatticeStructureFactor::LatticeStructureFactor(Kind kind, double area_fraction, double jitter, double domain,
                                               double angle, bool random_orientation)
    : kind_(kind), cosine_(std::cos(angle)), sine_(std::sin(angle)), random_(random_orientation) {
  const double most = closest_packing(kind);
  if (!(area_fraction > 0 && area_fraction <= most + kFractionTolerance))
    throw std::domain_error(std::string(kind == Kind::hexagonal ? "a hexagonal" : "a square") +
                            " lattice holds area fractions in (0, " + std::to_string(most) + "], got " +
                            std::to_string(area_fraction));
  spacing_ = 2 * std::sqrt(most / std::min(area_fraction, most));  // the spacing where discs touch is 2
  sigma_ = jitter * spacing_, length_ = domain * spacing_;
  if (!(length_ <= kLongestOrder))
    throw std::domain_error("domains of " + std::to_string(domain) +
                            " spacings have spots too small to be tabulated at "
                            "this area fraction; at most " +
                            std::to_string(kLongestOrder / spacing_) + " spacings");
  const double b = 2 * std::numbers::pi / spacing_;
  // Reciprocal basis of the lattice (1, 0), (1/2, sqrt(3)/2), or of (1, 0), (0, 1).
  bx_[0] = b, by_[0] = kind == Kind::hexagonal ? -b / std::numbers::sqrt3 : 0;
  bx_[1] = 0, by_[1] = kind == Kind::hexagonal ? 2 * b / std::numbers::sqrt3 : b;
  cell_ = bx_[0] * by_[1];
  if (random_) {
    // The shells of equal |G| and their numbers of points. The (2 reach + 1)^2 points contain all shells up
    // to 0.8 reach b.
    const int reach = 64;
    std::vector<double> radii;
    for (int i = -reach; i <= reach; ++i)
      for (int j = -reach; j <= reach; ++j)
        if (i != 0 || j != 0) radii.push_back(std::hypot(i * bx_[0] + j * bx_[1], i * by_[0] + j * by_[1]));
    std::sort(radii.begin(), radii.end());
    const double whole = 0.8 * reach * b;
    for (double r : radii) {
      if (r > whole) break;
      if (!shells_.empty() && r - shells_.back().first < 1e-9 * b)
        ++shells_.back().second;
      else
        shells_.emplace_back(r, 1);
    }
  }
}

double LatticeStructureFactor::eval(double u) const {
  if (!random_) return mean_over_ring(*this, u);
  u = std::abs(u);
  const double order = std::exp(-u * u * sigma_ * sigma_), l2 = length_ * length_;
  if (order < 1e-12 || shells_.empty() || u > shells_.back().first - 6 / length_) return 1;
  double sum = 0;
  const auto first = std::lower_bound(shells_.begin(), shells_.end(), std::pair{u - 8 / length_, 0});
  for (auto s = first; s != shells_.end() && s->first < u + 8 / length_; ++s) {
    // The mean of exp(-|q - G|^2 L^2/2) over the ring is exp(-(q^2 + G^2) L^2/2) I0(q G L^2).
    const double g = s->first, x = u * g * l2, d = (u - g) * length_;
    const double scaled =
        x < 600 ? bessel_i0(x) * std::exp(-x) : (1 + 1 / (8 * x)) / std::sqrt(2 * std::numbers::pi * x);
    sum += s->second * std::exp(-0.5 * d * d) * scaled;
  }
  return 1 - order + order * sum * cell_ * l2 / (2 * std::numbers::pi);
}

double LatticeStructureFactor::eval(double ux, double uy) const {
  if (random_) return eval(std::hypot(ux, uy));
  const double order = std::exp(-(ux * ux + uy * uy) * sigma_ * sigma_);
  if (order < 1e-12) return 1;
  const double x = ux * cosine_ + uy * sine_, y = uy * cosine_ - ux * sine_;
  const double l2 = length_ * length_;
  const int i0 = int(std::lround(x / bx_[0])), j0 = int(std::lround((y - x / bx_[0] * by_[0]) / by_[1]));
  double sum = 0;
  for (int i = i0 - 2; i <= i0 + 2; ++i)
    for (int j = j0 - 2; j <= j0 + 2; ++j) {
      if (i == 0 && j == 0) continue;
      const double dx = x - i * bx_[0] - j * bx_[1], dy = y - i * by_[0] - j * by_[1];
      const double exponent = 0.5 * (dx * dx + dy * dy) * l2;
      if (exponent < 40) sum += std::exp(-exponent);
    }
  return 1 - order + order * sum * cell_ * l2 / (2 * std::numbers::pi);
}

StretchedStructureFactor::StretchedStructureFactor(std::shared_ptr<const StructureFactor> unstretched,
                                                   double ratio, double angle)
    : unstretched_(std::move(unstretched)),
      stretch_(std::sqrt(ratio)),
      cosine_(std::cos(angle)),
      sine_(std::sin(angle)) {}

double StretchedStructureFactor::eval(double u) const { return mean_over_ring(*this, u); }

double StretchedStructureFactor::eval(double ux, double uy) const {
  const double along = (ux * cosine_ + uy * sine_) * stretch_,
               across = (uy * cosine_ - ux * sine_) / stretch_;
  return unstretched_->eval(along * cosine_ - across * sine_, along * sine_ + across * cosine_);
}

}  // namespace aureole::optics
