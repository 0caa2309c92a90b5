// SPDX-License-Identifier: Apache-2.0
// The phase function of Henyey & Greenstein 1941, "Diffuse radiation in the galaxy",
//     p = (1 - g^2) / (4 pi (1 + g^2 - 2 g cos(theta))^(3/2)),
// in a form that stays accurate for |g| near 1: 1 + g^2 - 2 |g| cos = (1 - |g|)^2 + 2 |g| (1 - cos), with the
// angle measured from the peak, forward for g > 0 and backward for g < 0.
#pragma once

#include <cmath>

#include "aureole/phase/lobe/deflection.h"
#include "aureole/plugin/properties.h"

namespace aureole {

class HenyeyGreenstein {
public:
  /// `g`: the mean cosine of the scattering angle, in (-1, 1).
  explicit HenyeyGreenstein(double g)
      : backward_(g < 0),
        g_(float(std::abs(g))),
        gap_(float(1 - std::abs(g))),
        factor_(float((1 - g * g) / (4 * M_PI))) {}

  /// Reads g from the parameter `name`. Throws a located Error unless -1 < g < 1.
  static HenyeyGreenstein from(const Properties& p, std::string_view name, double fallback) {
    const double g = p.get_float(name, fallback);
    if (!(g > -1 && g < 1)) throw p.error(name, "must lie between -1 and 1, without these two");
    return HenyeyGreenstein(g);
  }

  /// Returns the value [1/sr], which is also the pdf of `sample`.
  float eval(const Vec3& wi, const Vec3& wo) const {
    const float from_peak = backward_ ? one_plus_cos(wi, wo) : one_minus_cos(wi, wo);
    const float d = gap_ * gap_ + 2 * g_ * from_peak;
    return factor_ / (d * std::sqrt(d));
  }

  Vec3 sample(const Vec3& wi, Vec2 u) const {
    // Inverts the cumulative distribution over the angle from the peak.
    const float d = 1 + g_ - 2 * g_ * u.x;
    const float from_peak = 2 * gap_ * gap_ * u.x * (1 + g_ * (1 - u.x)) / (d * d);
    return turn_from(backward_ ? wi : -wi, from_peak, u.y);
  }

private:
  bool backward_;
  float g_, gap_, factor_;  // |g|, 1 - |g|, and the normalisation
};

}  // namespace aureole
