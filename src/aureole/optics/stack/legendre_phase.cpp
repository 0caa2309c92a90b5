// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/stack/legendre_phase.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "aureole/optics/constants.h"
#include "aureole/optics/gauss_legendre.h"

namespace aureole::optics {
namespace {

/// Calls visit(l, P_l(x)) for l in [0, count).
template <class Visit>
void for_each_legendre(int count, double x, const Visit& visit) {
  double p = 1, before = 0;
  for (int l = 0; l < count; ++l) {
    visit(l, p);
    const double next = ((2 * l + 1) * x * p - l * before) / (l + 1);
    before = p, p = next;
  }
}

std::vector<double> moments_of(const PhaseTable& table, int count) {
  std::vector<double> chi(count, 0);
  double sum = 0;
  for (std::size_t i = 0; i + 1 < table.mu.size(); ++i) {
    const double from = table.mu[i], to = table.mu[i + 1];
    // Number of nodes: P_l oscillates as cos(l theta), so that it is the number of radians in the step, or
    // the number that is exact for the product.
    const double turns =
        count * (std::acos(std::clamp(from, -1.0, 1.0)) - std::acos(std::clamp(to, -1.0, 1.0)));
    const Quadrature q = gauss_legendre(std::min(count / 2 + 2, 6 + int(turns)), from, to);
    for (std::size_t k = 0; k < q.x.size(); ++k) {
      const double t = (q.x[k] - from) / (to - from),
                   value = q.weight[k] * std::lerp(table.p[i], table.p[i + 1], t);
      sum += value;
      for_each_legendre(count, q.x[k], [&](int l, double p) { chi[l] += value * p; });
    }
  }
  for (double& c : chi) c /= sum;
  return chi;
}

void check_g(double g) {
  if (!(std::abs(g) < 1)) throw std::domain_error("g must be in (-1, 1), got " + std::to_string(g));
}

}  // namespace

LegendrePhase LegendrePhase::isotropic() { return henyey_greenstein(0); }

LegendrePhase LegendrePhase::henyey_greenstein(double g) { return double_henyey_greenstein({1, g, 0}); }

LegendrePhase LegendrePhase::double_henyey_greenstein(const DoubleHenyeyGreenstein& mixture) {
  check_g(mixture.g1), check_g(mixture.g2);
  if (!(mixture.share >= 0 && mixture.share <= 1))
    throw std::domain_error("share of the first phase function must be in [0, 1], got " +
                            std::to_string(mixture.share));
  return LegendrePhase(mixture);
}

LegendrePhase LegendrePhase::of_moments(std::vector<double> chi) {
  if (chi.empty() || !(std::abs(chi[0] - 1) < 1e-9))
    throw std::domain_error("the first moment of a phase function must be 1, got " +
                            (chi.empty() ? std::string("none") : std::to_string(chi[0])));
  for (std::size_t l = 1; l < chi.size(); ++l)
    if (!(std::abs(chi[l]) <= 1))
      throw std::domain_error("moments of a phase function must be in [-1, 1], got " +
                              std::to_string(chi[l]) + " (l = " + std::to_string(l) + ")");
  chi[0] = 1;
  return LegendrePhase(std::move(chi));
}

LegendrePhase LegendrePhase::table(PhaseTable table) {
  if (table.mu.size() < 2 || table.mu.size() != table.p.size())
    throw std::domain_error("the table of a phase function needs two or more cosines and as many values");
  if (table.mu.front() != -1 || table.mu.back() != 1)
    throw std::domain_error("the table of a phase function must go from mu = -1 to 1");
  for (std::size_t i = 0; i < table.mu.size(); ++i) {
    if (i > 0 && !(table.mu[i] > table.mu[i - 1]))
      throw std::domain_error("cosines of the table of a phase function must increase, got " +
                              std::to_string(table.mu[i]));
    if (!(table.p[i] >= 0 && std::isfinite(table.p[i])))
      throw std::domain_error("phase function must not be negative, got " + std::to_string(table.p[i]) +
                              " at mu = " + std::to_string(table.mu[i]));
  }
  const double sum = table.integral();
  if (!(sum > 0)) throw std::domain_error("phase function has no mass");
  for (double& p : table.p) p /= sum;
  return LegendrePhase(std::make_shared<const PhaseTable>(std::move(table)));
}

std::vector<double> LegendrePhase::moments(int count) const {
  std::vector<double> chi(count, 0);
  if (const auto* mixture = std::get_if<DoubleHenyeyGreenstein>(&kind_)) {
    double first = mixture->share, second = 1 - mixture->share;
    for (int l = 0; l < count; ++l, first *= mixture->g1, second *= mixture->g2) chi[l] = first + second;
  } else if (const auto* given = std::get_if<std::vector<double>>(&kind_)) {
    std::copy_n(given->begin(), std::min<std::size_t>(count, given->size()), chi.begin());
  } else {
    chi = moments_of(*std::get<2>(kind_), count);
  }
  return chi;
}

double LegendrePhase::eval(double mu) const {
  if (const auto* mixture = std::get_if<DoubleHenyeyGreenstein>(&kind_)) return mixture->eval(mu);
  if (const auto* given = std::get_if<std::vector<double>>(&kind_)) return legendre_series(*given, mu);
  return std::get<2>(kind_)->eval(mu);
}

double legendre_series(std::span<const double> chi, double mu) {
  double sum = 0;
  for_each_legendre(int(chi.size()), mu, [&](int l, double p) { sum += (2 * l + 1) * chi[l] * p; });
  return sum / (4 * kPi);
}

}  // namespace aureole::optics
