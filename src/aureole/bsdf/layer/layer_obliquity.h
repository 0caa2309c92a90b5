// SPDX-License-Identifier: Apache-2.0
// The factor O of light that `correlated_scatterers` diffracts at an angle.
#pragma once

#include "aureole/bsdf/bsdf.h"

namespace aureole {

class LayerObliquity {
public:
  /// Reads "obliquity". Throws located errors.
  static LayerObliquity from(const Properties& p);

  /// O = 1: radiance depends on direction cosines alone.
  bool is_reciprocal() const { return kind_ == Kind::reciprocal; }

  /// O for light between wi in media of index n_i and wo in n_o. With theta_s the angle of the light that is
  /// only refracted or reflected, not diffracted, to the side on which it leaves, and theta that of the light
  /// that leaves: cos theta_s/cos theta (fraunhofer), ((cos theta_s + cos theta)/2)^2/(cos theta_s cos theta)
  /// (kirchhoff); 0 where theta_s does not exist.
  Spectrum factor(const Vec3& wi, const Vec3& wo, const Spectrum& n_i, const Spectrum& n_o,
                  TransportMode mode) const;

private:
  enum class Kind { reciprocal, fraunhofer, kirchhoff };
  Kind kind_ = Kind::reciprocal;
};

}  // namespace aureole
