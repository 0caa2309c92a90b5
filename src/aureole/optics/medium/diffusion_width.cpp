// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/medium/diffusion_width.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <string>

namespace aureole::optics {

namespace {

/// Nodes of the table in 1 - albedo.
constexpr std::array kLosses = {0.7, 0.5, 0.3, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001};
constexpr std::array kIndices = {1.0, 1.25, 1.5, 2.0};
constexpr double kScales[kIndices.size()][kLosses.size()] = {
    {4.540, 3.737, 2.927, 2.446, 1.878, 1.500, 1.193, 1.048, 0.911, 0.825, 0.796},
    {6.154, 4.406, 2.841, 2.159, 1.561, 1.152, 0.920, 0.765, 0.669, 0.564, 0.516},
    {7.897, 5.379, 2.898, 2.054, 1.420, 1.085, 0.758, 0.639, 0.548, 0.467, 0.418},
    {7.976, 7.588, 2.689, 1.964, 1.305, 0.948, 0.633, 0.486, 0.429, 0.334, 0.285},
};

}  // namespace

DiffusionWidth::DiffusionWidth(double index, Illumination illumination) {
  if (!(index > 0)) throw std::domain_error("the index must be positive, got " + std::to_string(index));
  const double n = std::clamp(index, kIndices.front(), kIndices.back());
  const auto above = std::lower_bound(kIndices.begin() + 1, kIndices.end() - 1, n);
  const std::size_t k = std::size_t(above - kIndices.begin()) - 1;
  const double t = (n - kIndices[k]) / (kIndices[k + 1] - kIndices[k]);
  for (std::size_t i = 0; i < kLosses.size(); ++i) {
    reflectance_.push_back(half_space_reflectance(1 - kLosses[i], index, illumination));
    scale_.push_back(std::lerp(kScales[k][i], kScales[k + 1][i], t));
  }
}

double DiffusionWidth::scale(double reflectance) const {
  const double a = std::clamp(reflectance, reflectance_.front(), reflectance_.back());
  const auto above = std::lower_bound(reflectance_.begin() + 1, reflectance_.end() - 1, a);
  const std::size_t i = std::size_t(above - reflectance_.begin()) - 1;
  return std::lerp(scale_[i], scale_[i + 1], (a - reflectance_[i]) / (reflectance_[i + 1] - reflectance_[i]));
}

double published_diffusion_scale(double reflectance, Illumination illumination) {
  const double off = std::abs(reflectance - 0.8);
  return illumination == Illumination::normal ? 1.85 - reflectance + 7 * off * off * off
                                              : 1.9 - reflectance + 3.5 * off * off;
}

}  // namespace aureole::optics
