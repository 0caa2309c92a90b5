// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/grains.h"

#include <algorithm>

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

}  // namespace aureole::pigment
