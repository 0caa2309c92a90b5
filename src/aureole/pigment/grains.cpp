// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/grains.h"

#include <algorithm>
#include <cmath>
#include <complex>

namespace aureole::pigment {

Paint paint_of_grains(const optics::Suspension& suspension, std::span<const double> nm, Convention convention,
                      const ParallelFor& parallel_for) {
  const auto medium = suspension.spectrum({nm.begin(), nm.end()}, false, {}, parallel_for);
  Paint paint;
  for (const optics::EnsembleCoefficients& c : medium.coefficients) {
    paint.push_back(coefficients_of_transport(c.absorption, c.scattering, c.asymmetry, convention));
    paint.back().s = std::max(paint.back().s, 0.0);
  }
  return paint;
}

optics::IndexFunction rutile_index() {
  return [](double nm) {
    const double square = nm * nm * 1e-6;
    const double ordinary = std::sqrt(5.913 + 0.2441 / (square - 0.0803));
    const double extraordinary = std::sqrt(7.197 + 0.3322 / (square - 0.0843));
    return std::complex<double>((2 * ordinary + extraordinary) / 3);
  };
}

optics::IndexFunction carbon_black_index() {
  return [](double) { return std::complex<double>(1.95, 0.79); };
}

}  // namespace aureole::pigment
