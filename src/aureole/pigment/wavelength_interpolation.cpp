// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/wavelength_interpolation.h"

#include <algorithm>
#include <stdexcept>

namespace aureole::pigment {

InterpolationWeights interpolation_weights(std::span<const double> nm, double wavelength) {
  if (nm.size() < 2) throw std::domain_error("interpolation needs at least two wavelengths");
  const auto above = std::upper_bound(nm.begin(), nm.end(), wavelength);
  const std::size_t i = std::clamp<std::ptrdiff_t>(above - nm.begin(), 1, std::ptrdiff_t(nm.size()) - 1);
  const double l = std::clamp(wavelength, nm.front(), nm.back());
  // The cubic uses two points on either side, or the four points at an end.
  const std::size_t first =
      nm.size() < 4 ? 0 : std::clamp<std::ptrdiff_t>(std::ptrdiff_t(i) - 2, 0, std::ptrdiff_t(nm.size()) - 4);
  if (nm.size() < 4 || nm[first + 3] - nm[first] > 3 * kWidestCubicStep) {
    const double t = (l - nm[i - 1]) / (nm[i] - nm[i - 1]);
    return {i - 1, 2, {1 - t, t}};
  }
  InterpolationWeights result{first, 4, {}};
  const std::span<const double> four = nm.subspan(first, 4);
  for (std::size_t k = 0; k < 4; ++k) {
    result.weight[k] = 1;
    for (std::size_t j = 0; j < 4; ++j)
      if (j != k) result.weight[k] *= (l - four[j]) / (four[k] - four[j]);
  }
  return result;
}

std::vector<double> interpolated(std::span<const double> nm, std::span<const double> values,
                                 std::span<const double> wavelengths) {
  if (values.size() != nm.size())
    throw std::domain_error("a reflectance needs one value for each wavelength");
  std::vector<double> result;
  for (const double l : wavelengths) {
    const InterpolationWeights w = interpolation_weights(nm, l);
    double sum = 0;
    for (std::size_t j = 0; j < w.count; ++j) sum += w.weight[j] * values[w.first + j];
    result.push_back(sum);
  }
  return result;
}

}  // namespace aureole::pigment
