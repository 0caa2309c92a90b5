// SPDX-License-Identifier: Apache-2.0
// The phase function family. A phase function is a density over directions [1/sr] whose integral over the
// sphere is 1, without a cosine factor. Directions are in world space: `wi` is the given one (towards the
// previous vertex), `wo` the sampled one, both pointing away from the point. The cosine of the scattering
// angle is -dot(wi, wo). Values and pdfs are per wavelength.
#pragma once

#include <memory>
#include <optional>

#include "aureole/plugin/object.h"
#include "aureole/plugin/properties.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

struct PhaseContext {
  const Wavelengths& wavelengths;  ///< wavelengths of the path; index 0 is the hero
  Vec3 p;                          ///< the scattering point in world space
};

struct PhaseEval {
  Spectrum value{0.f};  ///< value of the phase function [1/sr]
  Spectrum pdf{0.f};    ///< pdf of sampling wo with `sample` [1/sr], per wavelength
};

struct PhaseSample {
  Vec3 wo;
  Spectrum value, pdf;  ///< value and pdf as `eval_pdf` returns them for wo; pdf[0] > 0
};

class PhaseFunction : public Object {
public:
  static constexpr const char* kFamily = "a phase function";
  using Object::Object;

  virtual PhaseEval eval_pdf(const Vec3& wi, const Vec3& wo, const PhaseContext& ctx) const = 0;
  /// Samples a direction for the hero wavelength; empty if there is none. `u1` chooses a lobe.
  virtual std::optional<PhaseSample> sample(const Vec3& wi, float u1, Vec2 u2,
                                            const PhaseContext& ctx) const = 0;

  /// Returns the factor of a medium's coefficients for light along `d`. It differs from 1 for oriented
  /// particles that are not spheres, which scatter and absorb in proportion to their projected area. It is
  /// symmetric in `d` and at most `largest_projected_area`.
  virtual float projected_area(const Vec3& /*d*/, const Vec3& /*p*/) const { return 1; }
  virtual float largest_projected_area() const { return 1; }
  /// Whether `projected_area` is 1 and the value depends only on the angle between wi and wo.
  virtual bool is_isotropic_medium() const { return true; }
  /// Whether the phase function is equal at all points.
  virtual bool is_uniform() const { return true; }
  /// Whether `sample` uses u1.
  virtual bool needs_choice() const { return false; }
};
using PhaseFunctionPtr = std::shared_ptr<const PhaseFunction>;

}  // namespace aureole
