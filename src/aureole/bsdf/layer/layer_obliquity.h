// SPDX-License-Identifier: Apache-2.0
// The obliquity factor O of light diffracted by `correlated_scatterers`.
#pragma once

#include "aureole/bsdf/bsdf.h"

namespace aureole {

class LayerObliquity {
public:
  /// Reads "obliquity". Throws located Errors.
  static LayerObliquity from(const Properties& p);

  /// Whether O = 1: radiance then depends on direction cosines alone.
  bool is_reciprocal() const { return kind_ == Kind::reciprocal; }

  /// Returns O for light between wi in media of index n_i and wo in n_o. theta_s is the angle of the
  /// refracted or reflected light without diffraction, on the outgoing side; theta is the angle of the
  /// outgoing light. O is cos theta_s/cos theta (fraunhofer) or ((cos theta_s + cos theta)/2)^2/(cos theta_s
  /// cos theta) (kirchhoff); 0 if theta_s does not exist.
  Spectrum factor(const Vec3& wi, const Vec3& wo, const Spectrum& n_i, const Spectrum& n_o,
                  TransportMode mode) const;

private:
  enum class Kind { reciprocal, fraunhofer, kirchhoff };
  Kind kind_ = Kind::reciprocal;
};

}  // namespace aureole
