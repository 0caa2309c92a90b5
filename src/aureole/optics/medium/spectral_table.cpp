// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/medium/spectral_table.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

namespace aureole::optics {

SpectralFunction spectral_table(std::span<const SpectralPoint> points) {
  if (points.empty()) throw std::domain_error("a spectrum needs at least one point");
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i > 0 && !(points[i].lambda_nm > points[i - 1].lambda_nm))
      throw std::domain_error("wavelengths of a spectrum must increase, got " +
                              std::to_string(points[i].lambda_nm) + " nm after " +
                              std::to_string(points[i - 1].lambda_nm) + " nm");
    if (!(points[i].value >= 0 && std::isfinite(points[i].value)))
      throw std::domain_error("value of a spectrum must not be negative, got " +
                              std::to_string(points[i].value) + " at " + std::to_string(points[i].lambda_nm) +
                              " nm");
  }
  return [table = std::vector<SpectralPoint>(points.begin(), points.end())](double lambda_nm) {
    if (!(lambda_nm > table.front().lambda_nm)) return table.front().value;
    if (lambda_nm >= table.back().lambda_nm) return table.back().value;
    const auto next = std::upper_bound(table.begin(), table.end(), lambda_nm,
                                       [](double at, const SpectralPoint& p) { return at < p.lambda_nm; });
    const SpectralPoint &a = next[-1], &b = *next;
    return a.value + (lambda_nm - a.lambda_nm) / (b.lambda_nm - a.lambda_nm) * (b.value - a.value);
  };
}

SpectralFunction spectral_constant(double value) {
  return [value](double) { return value; };
}

}  // namespace aureole::optics
