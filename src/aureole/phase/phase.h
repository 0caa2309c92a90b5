// SPDX-License-Identifier: Apache-2.0
// The phase function family. A phase function is a density over directions [1/sr] whose integral over the
// sphere is 1; it holds no cosine. Directions are in the world: `wi` is the given one (towards the previous
// vertex), `wo` the sampled one, both pointing away from the point. The cosine of the scattering angle is
// -dot(wi, wo). Values and densities are per wavelength.
#pragma once

#include <memory>
#include <optional>

#include "aureole/plugin/object.h"
#include "aureole/plugin/properties.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

struct PhaseContext {
  const Wavelengths& wavelengths;  ///< index 0 is the hero
  Vec3 p;                          ///< in the world
};

struct PhaseEval {
  Spectrum value{0.f};  ///< [1/sr]
  Spectrum pdf{0.f};    ///< density of `sample` for wo [1/sr] per wavelength
};

struct PhaseSample {
  Vec3 wo;
  Spectrum value, pdf;  ///< as `eval_pdf` gives them for wo; pdf[0] > 0
};

class PhaseFunction : public Object {
public:
  static constexpr const char* kFamily = "a phase function";
  using Object::Object;

  virtual PhaseEval eval_pdf(const Vec3& wi, const Vec3& wo, const PhaseContext& ctx) const = 0;
  /// A direction drawn for the hero wavelength; nothing where there is none. `u1` chooses between parts.
  virtual std::optional<PhaseSample> sample(const Vec3& wi, float u1, Vec2 u2,
                                            const PhaseContext& ctx) const = 0;

  /// Particles that are no spheres and not turned at random scatter and absorb by the area that they show to
  /// the light: the factor of a medium's coefficients for light along `d` (symmetric in d), at most
  /// `largest_projected_area`.
  virtual float projected_area(const Vec3& /*d*/, const Vec3& /*p*/) const { return 1; }
  virtual float largest_projected_area() const { return 1; }
  /// Whether `projected_area` is 1 and the value depends on the angle between wi and wo alone.
  virtual bool is_isotropic_medium() const { return true; }
  /// `sample` looks at u1.
  virtual bool needs_choice() const { return false; }
};
using PhaseFunctionPtr = std::shared_ptr<const PhaseFunction>;

}  // namespace aureole
