// SPDX-License-Identifier: Apache-2.0
// The GGX (Trowbridge-Reitz) distribution of microfacet normals with separable Smith masking: B. Walter et
// al., Microfacet models for refraction through rough surfaces, EGSR 2007, equations 33 and 34, in the
// anisotropic form of E. Heitz, Understanding the masking-shadowing function, JCGT 3(2), 2014.
#pragma once

#include <cmath>

#include "aureole/math/warp.h"

namespace aureole {

struct Ggx {
  float alpha_x, alpha_y;

  /// Density of normals [1/sr], m.z > 0: the integral of D cos(theta_m) over the hemisphere is one.
  float d(const Vec3& m) const {
    const float x = m.x / alpha_x, y = m.y / alpha_y, t = x * x + y * y + m.z * m.z;
    return kInvPi / (alpha_x * alpha_y * t * t);
  }
  /// Returns Smith's masking over the cosine, finite at grazing angles. v.z may have any sign; the caller
  /// checks whether the facet faces v.
  float g1_over_cos(const Vec3& v) const {
    const float x = alpha_x * v.x, y = alpha_y * v.y;
    return 2 / (std::abs(v.z) + std::sqrt(x * x + y * y + v.z * v.z));
  }
  float g1(const Vec3& v) const { return std::abs(v.z) * g1_over_cos(v); }

  /// Returns the density [1/sr] of the normals visible from `w`, w.z > 0.
  float visible_pdf(const Vec3& w, const Vec3& m) const {
    return g1_over_cos(w) * std::max(dot(w, m), 0.f) * d(m);
  }

  /// Samples a normal with density `visible_pdf` (J. Dupuy, A. Benyoub, Sampling visible GGX normals with
  /// spherical caps, Computer Graphics Forum 42(8), 2023). m.z > 0.
  Vec3 sample_visible(const Vec3& w, Vec2 u) const {
    const Vec3 s = normalize(Vec3{alpha_x * w.x, alpha_y * w.y, w.z});
    // A cap of directions c with c.z = up - s.z; 1 - c.z^2 is written without cancellation.
    const float up = (1 - u.x) * (1 + s.z);
    const float r = std::sqrt(std::max((1 + s.z) * u.x * (1 - s.z + up), 0.f));
    const Vec2 a = cos_sin_2pi(u.y);
    const Vec3 h{r * a.x + s.x, r * a.y + s.y, up};
    return normalize(Vec3{alpha_x * h.x, alpha_y * h.y, h.z});
  }
};

}  // namespace aureole
