// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/medium/diffusion_multipole.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "aureole/optics/gauss_legendre.h"
#include "aureole/optics/interface/fresnel_equations.h"

namespace aureole::optics {

Multipole::Multipole(const DiffusionCoefficients& medium, double index, double thickness)
    : effective_(medium.effective), albedo_(medium.reduced_albedo) {
  if (!(medium.transport > 0)) throw std::domain_error("a slab needs a medium with an extinction");
  if (!(index > 0)) throw std::domain_error("the index must be positive, got " + std::to_string(index));
  if (!(thickness > 0))
    throw std::domain_error("the thickness must be positive, got " + std::to_string(thickness));
  const double f = fresnel_diffuse_reflectance(1 / index);
  const double beyond = 2 * medium.diffusion * (1 + f) / (1 - f), source = medium.transport_length;
  period_ = thickness + 2 * beyond;
  // Images alternate and fall with the third power of their distance; in thick slabs absorption ends the series before.
  constexpr int kImages = 200;
  for (int i = -kImages; i <= kImages; ++i) {
    const double shift = 2 * i * period_;
    pairs_.push_back({shift + source, shift - source - 2 * beyond});
  }
  // The flux through the surface of a plane source between planes where the fluence is zero, cosh(s b) sinh(s (L - x))/sinh(s L), by
  // exponentials that do not overflow; the images' own sum depends on its order without absorption.
  const double s = effective_, x = std::min(source + beyond, period_);
  if (s * period_ < 1e-6)
    total_ = albedo_ * (period_ - x) / period_;
  else
    total_ = albedo_ * 0.5 * (std::exp(s * (beyond - x)) + std::exp(-s * (beyond + x))) *
             std::expm1(-2 * s * (period_ - x)) / std::expm1(-2 * s * period_);
}

double Multipole::profile(double distance) const {
  const auto part = [&](double z) {
    const double d = std::hypot(distance, z);
    return z * (effective_ + 1 / d) * std::exp(-effective_ * d) / (d * d);
  };
  double sum = 0;
  for (const Pair& p : pairs_) sum += part(p.source) - part(p.image);
  return albedo_ / (4 * std::numbers::pi) * sum;
}

double Multipole::within(double distance) const {
  // Light falls as exp(-pi r/L) at least.
  if (distance > 16 * period_) return total_;
  const auto part = [&](double z) {
    const double d = std::hypot(distance, z), h = std::abs(z);
    return z * (std::exp(-effective_ * h) / h - std::exp(-effective_ * d) / d);
  };
  double sum = 0;
  for (const Pair& p : pairs_) sum += part(p.source) - part(p.image);
  return albedo_ / 2 * sum;
}

double Multipole::line_profile(double distance) const {
  // With y = h sinh(t) the integrand falls as fast as exp(-t) at least; h keeps the nodes where the profile is wide.
  const double h = std::max(distance, pairs_[pairs_.size() / 2].source);
  static const Quadrature kNodes = gauss_legendre(96, 0, 12);
  double sum = 0;
  for (std::size_t k = 0; k < kNodes.x.size(); ++k) {
    const double y = h * std::sinh(kNodes.x[k]);
    sum += kNodes.weight[k] * h * std::cosh(kNodes.x[k]) * profile(std::hypot(distance, y));
  }
  return 2 * sum;
}

double port_part(const Multipole& slab, double viewed, double port) {
  const double all = slab.total();
  if (!(all > 0)) return 1;
  static const Quadrature kRadii = gauss_legendre(12, 0, 1), kSteps = gauss_legendre(64, 0, 1);
  double sum = 0;
  for (std::size_t i = 0; i < kRadii.x.size(); ++i) {
    // Radii of equal areas of the viewed disc.
    const double s = std::min(viewed, port) * std::sqrt(kRadii.x[i]);
    // Circles about the point lie in the port up to port - s, and partly up to port + s. By parts: the arcs' share falls while
    // `within` grows.
    double found = slab.within(port - s);
    if (s > 0)
      for (std::size_t k = 0; k < kSteps.x.size(); ++k) {
        const double r = port - s + 2 * s * kSteps.x[k];
        const double c = (s * s + r * r - port * port) / (2 * s * r);
        found += kSteps.weight[k] * 2 * s * 2 * std::numbers::pi * r * slab.profile(r) *
                 std::acos(std::clamp(c, -1.0, 1.0)) / std::numbers::pi;
      }
    sum += kRadii.weight[i] * found;
  }
  return std::min(sum / all, 1.0);
}

}  // namespace aureole::optics
