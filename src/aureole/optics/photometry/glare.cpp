// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/photometry/glare.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "aureole/optics/constants.h"

namespace aureole::optics {

double unified_glare_rating(double background, std::span<const GlareSource> sources) {
  if (!(background > 0)) throw std::domain_error("the luminance of the background must be positive");
  double sum = 0;
  for (const GlareSource& s : sources) {
    if (!(s.luminance >= 0 && s.solid_angle >= 0 && s.position > 0))
      throw std::domain_error(
          "a source of glare has a negative luminance or solid angle, or a position index of 0");
    sum += s.luminance * s.luminance * s.solid_angle / (s.position * s.position);
  }
  if (!(sum > 0)) return -std::numeric_limits<double>::infinity();
  return 8 * std::log10(0.25 / background * sum);
}

double position_index(double elevation, double to_the_side) {
  constexpr double kMost = 16;
  // Components of the direction in a frame with z along the line of sight and y up.
  const double y = std::sin(elevation), across = std::cos(elevation), x = across * std::sin(to_the_side),
               z = across * std::cos(to_the_side);
  if (!(z > 0)) return kMost;
  const double beta = std::atan2(std::hypot(x, y), z) / kDegree;  // angle from the line of sight
  if (y < 0) {
    // Ratio R/D, with R the distance from the line of sight and D the distance along it.
    const double ratio = std::hypot(x, y) / z;
    return std::min(kMost, 1 + (ratio < 0.6 ? 0.8 : 1.2) * ratio);
  }
  const double alpha = std::atan2(std::abs(x), y) / kDegree;  // angle of the source's plane from the vertical
  const double p = std::exp((35.2 - 0.31889 * alpha - 1.22 * std::exp(-2 * alpha / 9)) * 1e-3 * beta +
                            (21 + 0.26667 * alpha - 0.002963 * alpha * alpha) * 1e-5 * beta * beta);
  return std::min(kMost, p);
}

MesopicLuminance mesopic_luminance(double photopic, double scotopic_to_photopic) {
  if (!(photopic > 0 && scotopic_to_photopic >= 0))
    throw std::domain_error("the photopic luminance must be positive, and the ratio not negative");
  constexpr double kScotopicAt555 = 683.0 / 1699;
  const double scotopic = photopic * scotopic_to_photopic;
  const auto luminance = [&](double m) {
    return (m * photopic + (1 - m) * scotopic * kScotopicAt555) / (m + (1 - m) * kScotopicAt555);
  };
  // The standard iterates from m = 0.5. A damped iteration converges for every ratio.
  double m = 0.5;
  for (int i = 0; i < 500; ++i) {
    const double l = luminance(m);
    const double next = l > 0 ? std::clamp(0.7670 + 0.3334 * std::log10(l), 0.0, 1.0) : 0;
    const double before = m;
    m = 0.5 * (m + next);
    if (std::abs(m - before) < 1e-14) break;
  }
  return {luminance(m), m};
}

}  // namespace aureole::optics
