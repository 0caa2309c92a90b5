// SPDX-License-Identifier: Apache-2.0
#include "aureole/phase/mean_cosine.h"

#include <cmath>

namespace aureole {

Spectrum mean_over_azimuth(const PhaseFunction& phase, const Frame& about, double angle, const Vec3& p,
                           const Wavelengths& w) {
  // An isotropic medium (spheres, or particles of random orientation) has no dependence on the azimuth.
  const int azimuths = phase.is_isotropic_medium() ? 1 : 16;
  const float s = float(std::sin(angle)), c = float(std::cos(angle));
  Spectrum sum = 0.f;
  for (int k = 0; k < azimuths; ++k) {
    const float phi = float(2 * M_PI * (k + 0.5) / azimuths);
    const Vec3 wo = about.to_world({s * std::cos(phi), s * std::sin(phi), c});
    sum += phase.eval_pdf(-about.n, wo, {w, p}).value;
  }
  return sum * (1.f / float(azimuths));
}

std::array<double, kWavelengths> mean_cosine(const PhaseFunction& phase, const Frame& about, const Vec3& p,
                                             const Wavelengths& w) {
  // Midpoint rule with equal steps of sqrt(angle), since forward peaks may be seconds of arc wide.
  constexpr int kSteps = 4096;
  std::array<double, kWavelengths> sum{}, moment{};
  for (int i = 0; i < kSteps; ++i) {
    const double t = (i + 0.5) / kSteps, angle = M_PI * t * t;
    const double weight = std::sin(angle) * t, cosine = std::cos(angle);
    const Spectrum value = mean_over_azimuth(phase, about, angle, p, w);
    for (std::size_t k = 0; k < sum.size(); ++k) {
      const double share = weight * double(value[int(k)]);
      sum[k] += share, moment[k] += share * cosine;
    }
  }
  for (std::size_t k = 0; k < sum.size(); ++k) moment[k] = sum[k] > 0 ? moment[k] / sum[k] : 0;
  return moment;
}

}  // namespace aureole
