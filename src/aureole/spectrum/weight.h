// SPDX-License-Identifier: Apache-2.0
// `Weight`, the linear map from light that enters a part of a path to light that leaves it, and
// `Unpolarised`, the pair of types for light and maps of light that transport is compiled for. Weights are
// composed in path_density.h and in connections alone, in the order in which light passes them, so that types
// whose products do not commute (Stokes vectors and Mueller matrices) can take their place.
#pragma once

#include "aureole/math/vec.h"
#include "aureole/spectrum/spectrum.h"

namespace aureole {

/// A factor per wavelength, the weight of unpolarised light.
class Weight {
public:
  Weight() : factor_(1.f) {}
  explicit Weight(const Spectrum& factor) : factor_(factor) {}

  /// Light after this weight.
  Spectrum of(const Spectrum& light) const { return factor_ * light; }
  /// Returns the weight of light that passes `first` and then this weight.
  Weight after(const Weight& first) const { return Weight(factor_ * first.factor_); }
  Weight scaled(const Spectrum& s) const { return Weight(factor_ * s); }
  /// Absolute value of the factor, per wavelength.
  Spectrum magnitude() const { return abs(factor_); }
  bool is_black() const { return aureole::is_black(factor_); }

private:
  Spectrum factor_;
};

/// Light without polarisation: a spectrum as the light, and a factor per wavelength as the map of light. A
/// struct for another kind of light has equal members.
struct Unpolarised {
  using Light = Spectrum;
  using Weight = aureole::Weight;

  /// The map of light at a vertex at `p`, whose plug-in answers the scalar `f`: light that arrives there
  /// along the unit direction of travel `in` and leaves along `out`.
  static Weight lift(const Spectrum& f, const Vec3& /*p*/, const Vec3& /*in*/, const Vec3& /*out*/) {
    return Weight(f);
  }
  /// Returns the light of emitters and media that emit this radiance.
  static Light emitted(const Spectrum& radiance) { return radiance; }
  /// Returns the spectrum of a light that the film measures.
  static Spectrum measured(const Light& light) { return light; }

  static Light scaled(const Light& light, const Spectrum& s) { return light * s; }
  static Weight scaled(const Weight& weight, const Spectrum& s) { return weight.scaled(s); }
  /// Returns the size of light or of a map per wavelength, for Russian roulette and other choices.
  static Spectrum magnitude(const Light& light) { return abs(light); }
  static Spectrum magnitude(const Weight& weight) { return weight.magnitude(); }
  static bool is_black(const Light& light) { return aureole::is_black(light); }
  static bool is_black(const Weight& weight) { return weight.is_black(); }
};

}  // namespace aureole
