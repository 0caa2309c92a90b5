// SPDX-License-Identifier: Apache-2.0
// The interface through which a check evaluates a BSDF or a phase function: values, pdfs and samples for
// arrays of directions.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "aureole/bsdf/bsdf.h"
#include "aureole/instrument/check/check_options.h"

namespace aureole {

/// The hero wavelength and transport mode of an evaluation. A function is evaluated at `kWavelengths`
/// wavelengths spread over the range of the check; they are rotated so that wavelength number `hero` comes
/// first.
struct CheckQuery {
  int hero = 0;
  TransportMode mode = TransportMode::importance;
};

/// A scattering function of two directions, with the conventions of `Bsdf`.
class ScatteringFunction {
public:
  virtual ~ScatteringFunction() = default;

  /// True for a BSDF: values contain the cosine of wo with a surface, and lobes distinguish its two sides.
  /// False for a phase function.
  virtual bool is_on_surface() const = 0;
  virtual Lobe lobes() const = 0;

  /// Sets found[i] = eval_pdf(wi[i], wo[i]).
  virtual void eval_pdf(std::span<const Vec3> wi, std::span<const Vec3> wo, CheckQuery query,
                        std::span<BsdfEval> found) const = 0;
  /// Evaluates the values only.
  virtual void eval(std::span<const Vec3> wi, std::span<const Vec3> wo, CheckQuery query,
                    std::span<Spectrum> found) const = 0;
  /// Sets found[i] = sample(wi[i], u1[i], u2[i]).
  virtual void sample(std::span<const Vec3> wi, std::span<const float> u1, std::span<const Vec2> u2,
                      CheckQuery query, std::span<std::optional<BsdfSample>> found) const = 0;

  /// The wavelengths of a path whose hero is wavelength number `hero`.
  const Wavelengths& wavelengths(int hero) const { return rotated_[std::size_t(hero)]; }
  /// The projected area of the scatterer for direction w, per which values are reciprocal: |cos| for a
  /// surface, 1 for randomly oriented particles.
  virtual float area(const Vec3& w) const { return is_on_surface() ? std::abs(w.z) : 1; }

protected:
  /// The grid on which the spectra of an object are tabulated.
  static SpectralGrid grid_of(const Object& object, const CheckOptions& options);
  /// Uses the wavelength range of the options, or all of `grid`. Throws Error if the range is outside the
  /// grid; `kind` names the type of function in the message.
  ScatteringFunction(const SpectralGrid& grid, const CheckOptions& options, const char* kind);

private:
  std::vector<Wavelengths> rotated_;
};

}  // namespace aureole
