// SPDX-License-Identifier: Apache-2.0
// The medium family: matter that absorbs, scatters and emits light between surfaces.
#pragma once

#include <memory>

#include "aureole/medium/majorants.h"
#include "aureole/phase/phase.h"
#include "aureole/plugin/object.h"
#include "aureole/plugin/properties.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

/// Coefficients of a medium at a point, per wavelength. Lengths are in units of the scene.
struct MediumCoefficients {
  Spectrum sigma_t{0.f};   ///< extinction [1/length]
  Spectrum sigma_s{0.f};   ///< scattering [1/length], at most sigma_t
  Spectrum emission{0.f};  ///< emitted radiance per length, equal in all directions
};

class Medium : public Object {
public:
  static constexpr const char* kFamily = "a medium";
  using Object::Object;

  /// Evaluates the coefficients at the point p in world space, for light that travels along `d` or -d.
  virtual void eval(const Vec3& p, const Vec3& d, const Wavelengths& w, MediumCoefficients& out) const = 0;
  virtual const PhaseFunction& phase() const = 0;

  /// Upper bounds of the density, with sigma_t(p, d, w) <= bound majorant(d, w). Where the density does not
  /// vary, sigma_t is majorant(d, w) everywhere.
  virtual Majorants majorants() const { return {}; }
  virtual Spectrum majorant(const Vec3& d, const Wavelengths& w) const = 0;

  /// Whether `eval` is constant in space. `has_uniform_emission` says whether the emission is.
  virtual bool is_uniform() const = 0;
  virtual bool has_uniform_emission() const = 0;
  virtual bool emits() const = 0;
  /// Whether light can be scattered; false if the albedo is 0 everywhere.
  virtual bool scatters() const { return true; }
  /// Factor of the probability with which next-event estimation chooses this medium's emission; 0: never.
  virtual float sampling_weight() const { return 1; }
};
using MediumPtr = std::shared_ptr<const Medium>;

/// Returns the phase function among a medium's children, or an isotropic one. Throws Error if there are several.
PhaseFunctionPtr only_phase(const Properties& properties);

/// Returns the medium among an object's children, or null. Throws a located Error if there are several.
MediumPtr only_medium(const Properties& properties);

}  // namespace aureole
