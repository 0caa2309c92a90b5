// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/observation.h"

#include <algorithm>

#include "aureole/pigment/domain.h"

namespace aureole::pigment {

namespace {

/// Wider gaps between wavelengths are bridged by straight lines.
constexpr double kWidestStep = 20.5;

/// Weights of values at four wavelengths in the cubic through them, at wavelength `l` (Lagrange).
std::array<double, 4> lagrange(std::span<const double, 4> nm, double l) {
  std::array<double, 4> weights{};
  for (std::size_t i = 0; i < 4; ++i) {
    weights[i] = 1;
    for (std::size_t j = 0; j < 4; ++j)
      if (j != i) weights[i] *= (l - nm[j]) / (nm[i] - nm[j]);
  }
  return weights;
}

}  // namespace

Observation::Observation(std::string name, std::span<const double> nm,
                         const std::function<double(double)>& lamp,
                         const std::array<std::function<double(double)>, 3>& observer)
    : name_(std::move(name)), weights_(nm.size()) {
  if (nm.size() < 2) throw std::domain_error("a reflectance needs at least two wavelengths to have a colour");
  for (std::size_t i = 1; i < nm.size(); ++i)
    require(nm[i] > nm[i - 1], nm[i], "wavelengths", "must increase");
  double outside = 0;
  for (int wavelength = 360; wavelength <= 830; ++wavelength) {
    const double power = lamp(wavelength);
    const auto above = std::upper_bound(nm.begin(), nm.end(), double(wavelength));
    const std::size_t i = std::clamp<std::ptrdiff_t>(above - nm.begin(), 1, std::ptrdiff_t(nm.size()) - 1);
    const double l = std::clamp(double(wavelength), nm.front(), nm.back());
    // Two points on either side, or the four at an end.
    const std::size_t first =
        nm.size() < 4 ? 0
                      : std::clamp<std::ptrdiff_t>(std::ptrdiff_t(i) - 2, 0, std::ptrdiff_t(nm.size()) - 4);
    const bool is_cubic = nm.size() >= 4 && nm[first + 3] - nm[first] <= 3 * kWidestStep;
    const std::array<double, 4> cubic =
        is_cubic ? lagrange(nm.subspan(first).first<4>(), l) : std::array<double, 4>{};
    const double t = (l - nm[i - 1]) / (nm[i] - nm[i - 1]);
    for (std::size_t c = 0; c < 3; ++c) {
      const double weight = power * observer[c](wavelength);
      if (is_cubic) {
        for (std::size_t j = 0; j < 4; ++j) weights_[first + j][c] += weight * cubic[j];
      } else {
        weights_[i - 1][c] += weight * (1 - t);
        weights_[i][c] += weight * t;
      }
      white_[c] += weight;
      if (c == 1 && (wavelength < nm.front() || wavelength > nm.back())) outside += weight;
    }
  }
  require(white_[1] > 0, white_[1], "luminance of the lamp " + name_, "must be positive");
  if (outside > 0.02 * white_[1])
    throw std::domain_error("wavelengths from " + number_text(nm.front()) + " to " + number_text(nm.back()) +
                            " nm leave out too much of the visible to give a colour");
  const double scale = 1 / white_[1];
  for (Xyz& w : weights_)
    for (double& v : w) v *= scale;
  for (double& v : white_) v *= scale;
}

Observation Observation::grouped(std::size_t group) const {
  require(group >= 1, double(group), "the number of wavelengths of a group", "must be positive");
  Observation result = *this;
  result.weights_.assign((weights_.size() + group - 1) / group, Xyz{});
  for (std::size_t i = 0; i < weights_.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) result.weights_[i / group][c] += weights_[i][c];
  return result;
}

Xyz Observation::xyz(std::span<const double> reflectance) const {
  if (reflectance.size() != weights_.size())
    throw std::domain_error("a reflectance needs one value for each wavelength of the observation");
  Xyz sum{};
  for (std::size_t i = 0; i < weights_.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) sum[c] += weights_[i][c] * reflectance[i];
  return sum;
}

}  // namespace aureole::pigment
