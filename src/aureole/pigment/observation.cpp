// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/observation.h"

#include "aureole/pigment/domain.h"
#include "aureole/pigment/wavelength_interpolation.h"

namespace aureole::pigment {

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
    const InterpolationWeights between = interpolation_weights(nm, wavelength);
    for (std::size_t c = 0; c < 3; ++c) {
      const double weight = power * observer[c](wavelength);
      for (std::size_t j = 0; j < between.count; ++j)
        weights_[between.first + j][c] += weight * between.weight[j];
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
