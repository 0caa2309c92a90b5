// SPDX-License-Identifier: Apache-2.0
// `PlaceDensity`: the density by which the point on an edge around which light goes between two ends is
// sampled. Any density that is positive everywhere on the edge is correct; the choice only affects the noise.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "aureole/math/erf_inverse.h"

namespace aureole {

/// A density on an edge, over [0, length]: a mixture of a Gaussian about Keller's point, two exponentials
/// near the ends, where corners diffract, and a uniform density.
class PlaceDensity {
public:
  PlaceDensity(std::optional<double> keller, double deviation, double end_scale, double length)
      : length_(length), end_scale_(end_scale) {
    if (keller && deviation < 4 * length) {
      middle_ = *keller, deviation_ = deviation;
      const double scale = 1 / (deviation_ * std::numbers::sqrt2);
      // A shortcut: most edges contain the whole Gaussian.
      low_ = middle_ * scale > 6 ? -1 : std::erf(-middle_ * scale);
      high_ = (length_ - middle_) * scale > 6 ? 1 : std::erf((length_ - middle_) * scale);
      const double mass = 0.5 * (high_ - low_);
      if (mass > 1e-6) share_ = 0.9 * std::min(1.0, 20 * mass), inverse_mass_ = 1 / mass;
    }
    if (end_scale_ < 0.25 * length_)
      end_share_ = 0.6 * (1 - share_), end_mass_ = -std::expm1(-length_ / end_scale_);
  }

  double sample(double u, double v) const {
    if (u < share_) {
      const double scale = std::numbers::sqrt2 * deviation_;
      return std::clamp(middle_ + scale * sample_between(low_, high_, v), 0.0, length_);
    }
    u = (u - share_) / (1 - share_);
    const double ends = end_share_ / (1 - share_);
    if (u < ends) {
      const double l = -end_scale_ * std::log1p(-v * end_mass_);
      return std::clamp(u < 0.5 * ends ? l : length_ - l, 0.0, length_);
    }
    return v * length_;
  }
  double pdf(double l) const {
    double p = (1 - share_ - end_share_) / length_;
    if (share_ > 0) {
      const double z = (l - middle_) / deviation_;
      p += share_ * inverse_mass_ * std::exp(-0.5 * z * z) / (deviation_ * std::sqrt(2 * std::numbers::pi));
    }
    if (end_share_ > 0)
      p += 0.5 * end_share_ * (std::exp(-l / end_scale_) + std::exp(-(length_ - l) / end_scale_)) /
           (end_scale_ * end_mass_);
    return p;
  }

private:
  double length_, end_scale_, middle_ = 0, deviation_ = 1, low_ = 0, high_ = 0, inverse_mass_ = 0, share_ = 0,
                              end_share_ = 0, end_mass_ = 1;
};

}  // namespace aureole
