// SPDX-License-Identifier: Apache-2.0
// The view that a check has of a BSDF or of a phase function: values, densities and samples for arrays of
// directions.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "aureole/bsdf/bsdf.h"
#include "aureole/instrument/check/check_options.h"

namespace aureole {

/// A function is evaluated at `kWavelengths` wavelengths spread over the range of the check, any of which may
/// be the hero of a path: `hero` of them are rotated away from the front.
struct CheckQuery {
  int hero = 0;
  TransportMode mode = TransportMode::importance;
};

/// A function of two directions that scatters light, with the conventions of `Bsdf`.
class ScatteringFunction {
public:
  virtual ~ScatteringFunction() = default;

  /// Values hold the cosine of wo with a surface, on whose two sides lobes are told apart: a BSDF. Values of
  /// a phase function hold none.
  virtual bool is_on_surface() const = 0;
  virtual Lobe lobes() const = 0;

  /// found[i] = eval_pdf(wi[i], wo[i]).
  virtual void eval_pdf(std::span<const Vec3> wi, std::span<const Vec3> wo, CheckQuery query,
                        std::span<BsdfEval> found) const = 0;
  /// The values alone.
  virtual void eval(std::span<const Vec3> wi, std::span<const Vec3> wo, CheckQuery query,
                    std::span<Spectrum> found) const = 0;
  /// found[i] = sample(wi[i], u1[i], u2[i]).
  virtual void sample(std::span<const Vec3> wi, std::span<const float> u1, std::span<const Vec2> u2,
                      CheckQuery query, std::span<std::optional<BsdfSample>> found) const = 0;

  /// The wavelengths of a path whose hero is number `hero` of them.
  const Wavelengths& wavelengths(int hero) const { return rotated_[std::size_t(hero)]; }
  /// The area that the scatterer shows to w, over which values are reciprocal: the cosine with a surface, 1
  /// for particles that are turned at random.
  virtual float area(const Vec3& w) const { return is_on_surface() ? std::abs(w.z) : 1; }

protected:
  /// The grid on which the spectra of an object are tabulated.
  static SpectralGrid grid_of(const Object& object, const CheckOptions& options);
  /// Takes the wavelengths of the options, or all of `grid`. Throws Error where they lie outside of it;
  /// `kind` is the word for the function in that message.
  ScatteringFunction(const SpectralGrid& grid, const CheckOptions& options, const char* kind);

private:
  std::vector<Wavelengths> rotated_;
};

}  // namespace aureole
