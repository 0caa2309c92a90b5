// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/scatterer_layer.h"

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/special_functions/bessel.hpp>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "aureole/optics/aperture_transform.h"
#include "aureole/optics/structure_factor.h"

namespace aureole::optics {
namespace {

constexpr double kPi = std::numbers::pi;

void check_size_ratio(double size_ratio) {
  if (!(size_ratio >= kMinSizeRatio && size_ratio <= 1))
    throw std::domain_error("shape radius over correlation radius must be in [1/64, 1], got " +
                            std::to_string(size_ratio));
}

double checked_radius(double radius, const char* name) {
  if (!(radius > 0 && std::isfinite(radius)))
    throw std::domain_error(std::string(name) + " must be positive and finite, got " +
                            std::to_string(radius));
  return radius;
}

/// Part of Airy's pattern beyond x = |q| radius: J0(x)^2 + J1(x)^2 (Born & Wolf 1999, section 8.5.2).
double airy_power_beyond(double x) {
  const double j0 = boost::math::cyl_bessel_j(0, x), j1 = boost::math::cyl_bessel_j(1, x);
  return j0 * j0 + j1 * j1;
}

}  // namespace

double radial_intensity(double u, double size_ratio, double area_fraction) {
  check_size_ratio(size_ratio);
  const double shape = circle_transform(size_ratio * u);
  return shape * shape * hard_disc_structure_factor(u, area_fraction);
}

double radial_intensity_integral(double size_ratio, double area_fraction) {
  check_size_ratio(size_ratio);
  // The integrand falls as u^-2 only. Without interference its integral is known, 2/size_ratio^2, and what
  // interference changes falls as u^-3.5: from 400 on it holds less than 1e-6 of the integral.
  const auto change = [=](double u) {
    const double shape = circle_transform(size_ratio * u);
    return shape * shape * (hard_disc_structure_factor(u, area_fraction) - 1) * u;
  };
  using Rule = boost::math::quadrature::gauss<double, 10>;
  double sum = 0;
  // S' is sharply peaked near u = 3 at high area fractions and swings with period pi further out.
  for (int i = 0; i < 128; ++i) sum += Rule::integrate(change, i / 8.0, (i + 1) / 8.0);
  for (int i = 16; i < 400; ++i) sum += Rule::integrate(change, double(i), double(i + 1));
  return 2 / (size_ratio * size_ratio) + sum;
}

ScattererLayer::ScattererLayer(double shape_radius, double correlation_radius, double area_fraction)
    : shape_radius_(checked_radius(shape_radius, "shape radius")),
      correlation_radius_(checked_radius(correlation_radius, "correlation radius")),
      area_fraction_(area_fraction) {
  const double ratio = shape_radius / correlation_radius;
  // J over its Poisson value, so that the normalisation of an empty layer is its limit and not 0/0.
  const double relative_total = 0.5 * ratio * ratio * radial_intensity_integral(ratio, area_fraction);
  shape_fraction_ = area_fraction * ratio * ratio;
  total_ = shape_fraction_ * relative_total;
  normalisation_ = (1 - shape_fraction_) / relative_total;
}

double ScattererLayer::intensity(double q) const {
  const double density = area_fraction_ / (kPi * correlation_radius_ * correlation_radius_);
  const double f = circle_aperture_transform(q, shape_radius_);
  return density * f * f * hard_disc_structure_factor(q * correlation_radius_, area_fraction_);
}

RadialTable::Cell RadialTable::cell(int index) {
  if (index < kFineCells) return {double(index) / kFineRate, 1.0 / kFineRate};
  return {kSplit + double(index - kFineCells) / kCoarseRate, 1.0 / kCoarseRate};
}

RadialTable::RadialTable(double size_ratio, double area_fraction) : nodes_(kCells + 2), power_(kCells + 1) {
  check_size_ratio(size_ratio);
  std::vector<double> exact(kCells + 1);
  double total = 0;
  for (int i = 0; i <= kCells; ++i) {
    const double u = cell(i).start;
    exact[i] = u * radial_intensity(u, size_ratio, area_fraction);
    if (i > 0) total += 0.5 * (exact[i - 1] + exact[i]) * cell(i - 1).width;
  }
  // Past the table S' is 1 to 1e-5 or so and the rings average out: a tail c/u^2 keeps the power c/kEnd.
  const double beyond = 2 / (size_ratio * size_ratio) * airy_power_beyond(size_ratio * kEnd);
  exact[kCells] = beyond / kEnd;
  total += beyond;

  // The distribution is made of the rounded nodes that `eval` reads, so that it is theirs and not a near one.
  for (int i = 0; i <= kCells; ++i) nodes_[i] = static_cast<float>(exact[i] / total);
  for (int i = 0; i < kCells; ++i)
    power_[i + 1] = power_[i] + 0.5 * (double(nodes_[i]) + double(nodes_[i + 1])) * cell(i).width;
  tail_ = double(nodes_[kCells]) * kEnd * kEnd;
  total_ = power_[kCells] + tail_ / kEnd;
}

/// Integral of u' g(u') total_ over [0, u].
double RadialTable::power(double u) const {
  if (!(u > 0)) return 0;
  if (u >= kEnd) return total_ - tail_ / u;
  double fraction;
  const int i = find_cell(u, fraction);
  const double a = nodes_[i], b = nodes_[i + 1];
  return power_[i] + cell(i).width * fraction * (a + 0.5 * fraction * (b - a));
}

double RadialTable::sample(double xi, double u_max) const {
  const double target = xi * power(u_max);
  if (!(target > 0)) return 0;
  if (target >= power_[kCells]) return target < total_ ? std::min(tail_ / (total_ - target), u_max) : u_max;
  const int i = int(std::upper_bound(power_.begin(), power_.end(), target) - power_.begin()) - 1;
  // The root of fraction (a + fraction (b - a)/2) = rest, in the form that does not divide by b - a.
  const double a = nodes_[i], b = nodes_[i + 1], rest = (target - power_[i]) / cell(i).width;
  const double denominator = a + std::sqrt(std::max(0.0, a * a + 2 * (b - a) * rest));
  const double fraction = denominator > 0 ? std::min(2 * rest / denominator, 1.0) : 0.0;
  return std::min(cell(i).start + fraction * cell(i).width, u_max);
}

}  // namespace aureole::optics
