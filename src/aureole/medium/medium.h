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
  Spectrum emission{0.f};  ///< emitted radiance per length, towards the origin of a ray
};

class Medium : public Object {
public:
  static constexpr const char* kFamily = "a medium";
  using Object::Object;

  /// Evaluates the coefficients at the point p in world space, for light that travels along `d` or -d; the emission is that
  /// of light along -d, which a viewer who looks along `d` sees.
  virtual void eval(const Vec3& p, const Vec3& d, const Wavelengths& w, MediumCoefficients& out) const = 0;
  virtual const PhaseFunction& phase() const = 0;

  /// Upper bounds of the density, with sigma_t(p, d, w) <= bound majorant(d, w). Where the density does not
  /// vary, sigma_t is majorant(d, w) everywhere.
  virtual Majorants majorants() const { return {}; }
  virtual Spectrum majorant(const Vec3& d, const Wavelengths& w) const = 0;

  /// Whether the two functions below give the optical thickness along rays in closed form. For media that vary, do not emit,
  /// and have one extinction at all wavelengths: distances are then sampled by it, and connections have no noise.
  virtual bool has_closed_form() const { return false; }
  /// Optical thickness along a ray of unit direction up to the distance t_max.
  virtual double optical_thickness(const Ray& /*ray*/, float /*t_max*/) const { return 0; }
  /// The distance at which the thickness is `wanted`; infinity where that is beyond t_max.
  virtual float distance_of_thickness(const Ray& /*ray*/, float /*t_max*/, double /*wanted*/) const {
    return kInfinity;
  }

  /// Whether `eval` is constant in space; `has_uniform_emission` says so of the emission alone.
  virtual bool is_uniform() const = 0;
  virtual bool has_uniform_emission() const = 0;
  virtual bool emits() const = 0;
  /// Whether the emission depends on the direction.
  virtual bool emits_by_direction() const { return false; }
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
