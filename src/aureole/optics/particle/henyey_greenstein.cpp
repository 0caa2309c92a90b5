// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/particle/henyey_greenstein.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>

namespace aureole::optics {
namespace {

constexpr double kLargest = 0.99999;

/// Both g are roots of z^2 - b z + c, since the moments satisfy the recurrence m_(l+1) = b m_l - c m_(l-1).
std::optional<DoubleHenyeyGreenstein> by_moments(double m1, double m2, double m3) {
  const double spread = m2 - m1 * m1;
  if (!(spread > 1e-12)) return std::nullopt;
  const double b = (m3 - m1 * m2) / spread, c = b * m1 - m2, discriminant = b * b / 4 - c;
  if (!(discriminant > 0)) return std::nullopt;
  const double root = std::sqrt(discriminant);
  DoubleHenyeyGreenstein fit{0, b / 2 + root, b / 2 - root};
  fit.share = (m1 - fit.g2) / (fit.g1 - fit.g2);
  if (!(fit.g1 <= kLargest && fit.g2 >= -kLargest && fit.share >= 0 && fit.share <= 1)) return std::nullopt;
  return fit;
}

}  // namespace

double henyey_greenstein(double mu, double g) {
  if (!(std::abs(g) < 1)) throw std::domain_error("g must be in (-1, 1), got " + std::to_string(g));
  const double d = 1 + g * g - 2 * g * mu;
  return (1 - g * g) / (4 * std::numbers::pi * d * std::sqrt(d));
}

double DoubleHenyeyGreenstein::eval(double mu) const {
  return share * henyey_greenstein(mu, g1) + (1 - share) * henyey_greenstein(mu, g2);
}

double fit_henyey_greenstein(const PhaseTable& phase) { return phase.asymmetry(); }

DoubleHenyeyGreenstein fit_double_henyey_greenstein(const PhaseTable& phase) {
  const double m1 = phase.legendre(1), m2 = phase.legendre(2), m3 = phase.legendre(3);
  if (const auto fit = by_moments(m1, m2, m3)) return *fit;
  // The search for both g uses successively finer grids around the best pair; the share follows from m1.
  DoubleHenyeyGreenstein best{1, m1, m1};
  const auto error = [&](const DoubleHenyeyGreenstein& f) {
    const double e2 = f.share * f.g1 * f.g1 + (1 - f.share) * f.g2 * f.g2 - m2;
    const double e3 = f.share * std::pow(f.g1, 3) + (1 - f.share) * std::pow(f.g2, 3) - m3;
    return 5 * e2 * e2 + 7 * e3 * e3;  // the factors 2 l + 1 give the squared difference of the series
  };
  double least = error(best);
  constexpr int kSteps = 20;
  for (double width = 1; width > 1e-7; width *= 0.25) {
    const double g1 = best.g1, g2 = best.g2;
    for (int i = -kSteps; i <= kSteps; ++i)
      for (int j = -kSteps; j <= kSteps; ++j) {
        const double high = std::clamp(g1 + width * i / kSteps, m1, kLargest);
        const double low = std::clamp(g2 + width * j / kSteps, -kLargest, m1);
        if (!(high > low)) continue;
        const DoubleHenyeyGreenstein trial{(m1 - low) / (high - low), high, low};
        if (const double e = error(trial); e < least) best = trial, least = e;
      }
  }
  return best;
}

}  // namespace aureole::optics
