// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/medium/half_space.h"

#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "aureole/optics/interface/fresnel_equations.h"

namespace aureole::optics {

namespace {

/// Nodes and weights for integrals over cosines in [0, 1], divided at `kink`.
struct Cosines {
  std::vector<double> mu, weight;

  explicit Cosines(double kink) {
    if (kink > 0) add(0, kink);
    add(kink, 1);
  }
  std::size_t size() const { return mu.size(); }

private:
  void add(double from, double to) {
    using Rule = boost::math::quadrature::gauss<double, 24>;
    const double half = (to - from) / 2, middle = (from + to) / 2;
    for (std::size_t i = 0; i < Rule::abscissa().size(); ++i)
      for (const double sign : {-1.0, 1.0}) {
        // The reflectance behaves as the square root of the distance to the kink: the substitution t^2
        // smooths it.
        const double t = (1 + sign * Rule::abscissa()[i]) / 2;
        const bool above = from > 0;
        mu.push_back(above ? from + (to - from) * t * t : middle + half * (2 * t - 1));
        weight.push_back(Rule::weights()[i] * half * (above ? 2 * t : 1));
      }
  }
};

/// Returns H at the nodes by iteration: 1/H(mu) = sqrt(1 - albedo) + albedo/2 integral of mu' H(mu')/(mu +
/// mu') (Chandrasekhar 1950, section 38).
std::vector<double> h_function(double albedo, const Cosines& c) {
  std::vector<double> h(c.size(), 1.0);
  for (int step = 0; step < 2000; ++step) {
    double change = 0;
    std::vector<double> next(c.size());
    for (std::size_t i = 0; i < c.size(); ++i) {
      double sum = 0;
      for (std::size_t j = 0; j < c.size(); ++j) sum += c.weight[j] * c.mu[j] * h[j] / (c.mu[i] + c.mu[j]);
      // The mean with the previous iterate damps oscillations.
      next[i] = (h[i] + 1 / (std::sqrt(1 - albedo) + albedo / 2 * sum)) / 2;
      change = std::max(change, std::abs(next[i] - h[i]));
    }
    h = std::move(next);
    if (change < 1e-12) break;
  }
  return h;
}

/// Solves a x = b by elimination without pivoting; a is diagonally dominant, since light is lost at every
/// reflection.
std::vector<double> solve(std::vector<std::vector<double>> a, std::vector<double> b) {
  const std::size_t n = b.size();
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t i = k + 1; i < n; ++i) {
      const double f = a[i][k] / a[k][k];
      if (f == 0) continue;
      for (std::size_t j = k; j < n; ++j) a[i][j] -= f * a[k][j];
      b[i] -= f * b[k];
    }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = k + 1; j < n; ++j) b[k] -= a[k][j] * b[j];
    b[k] /= a[k][k];
  }
  return b;
}

}  // namespace

double half_space_reflectance(double albedo, double index, Illumination illumination) {
  if (!(albedo >= 0 && albedo <= 1))
    throw std::domain_error("albedo must be in [0, 1], got " + std::to_string(albedo));
  if (!(index > 0)) throw std::domain_error("the index must be positive, got " + std::to_string(index));
  const Cosines c(index > 1 ? std::sqrt(1 - 1 / (index * index)) : 0);
  const std::size_t n = c.size();
  const std::vector<double> h = h_function(albedo, c);
  std::vector<double> inside(n);  // Fresnel reflectance for light from inside
  for (std::size_t i = 0; i < n; ++i) inside[i] = fresnel_reflectance(c.mu[i], index, 1);

  // Upward radiance per downward irradiance perpendicular to a beam: albedo/(4 pi) mu'/(mu + mu') H(mu)
  // H(mu'). Azimuthal factors of 2 pi are left out: `up` is 2 pi times the radiance.
  const auto reflected = [&](double mu, double h_mu, double from, double h_from) {
    return albedo / 2 * from / (mu + from) * h_mu * h_from;
  };
  std::vector<double> first(n, 0.0);
  double entered = 0;
  if (illumination == Illumination::normal) {
    double sum = 0;
    for (std::size_t j = 0; j < n; ++j) sum += c.weight[j] * c.mu[j] * h[j] / (1 + c.mu[j]);
    const double h1 = 1 / (std::sqrt(1 - albedo) + albedo / 2 * sum);
    for (std::size_t i = 0; i < n; ++i) first[i] = reflected(c.mu[i], h[i], 1, h1);
    entered = 1;
  } else {
    for (std::size_t j = 0; j < n; ++j) {
      const double beam = c.weight[j] * (1 - inside[j]);
      entered += beam * c.mu[j];
      for (std::size_t i = 0; i < n; ++i) first[i] += beam * reflected(c.mu[i], h[i], c.mu[j], h[j]);
    }
  }
  std::vector<std::vector<double>> turn(n, std::vector<double>(n));
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      turn[i][j] = (i == j ? 1.0 : 0.0) - c.weight[j] * inside[j] * reflected(c.mu[i], h[i], c.mu[j], h[j]);
  const std::vector<double> up = solve(std::move(turn), std::move(first));
  double left = 0;
  for (std::size_t i = 0; i < n; ++i) left += c.weight[i] * c.mu[i] * (1 - inside[i]) * up[i];
  return left / entered;
}

}  // namespace aureole::optics
