// SPDX-License-Identifier: Apache-2.0
// Amplitudes of the specular reflection of a BSDF, for waves that interfere: edges between faces that reflect.
#pragma once

#include <array>
#include <complex>

#include "aureole/bsdf/bsdf.h"
#include "aureole/optics/interface/fresnel_equations.h"

namespace aureole {

/// An interface that a BSDF implements besides `Bsdf`, found by `mirror_reflection_of`. Its delta lobe of reflection has an amplitude and not a
/// power alone.
class MirrorReflection {
public:
  virtual ~MirrorReflection() = default;

  /// Ratios of the complex amplitudes of reflected to incident light at each wavelength, for time dependence exp(-i omega t).
  struct Amplitudes {
    /// electric field perpendicular to the plane of incidence; -1 for a perfect mirror
    std::array<std::complex<double>, kWavelengths> s;
    /// electric field in the plane of incidence, as the ratio of the magnetic fields; +1 for a perfect mirror
    std::array<std::complex<double>, kWavelengths> p;

    /// Multiplies powers by `factor`.
    void scale(const Spectrum& factor) {
      for (int i = 0; i < kWavelengths; ++i) {
        const double root = std::sqrt(double(factor[i]));
        s[std::size_t(i)] *= root, p[std::size_t(i)] *= root;
      }
    }
  };
  /// `cos_i` in [0, 1]: cosine of the angle of incidence, on the side of the normal.
  virtual Amplitudes reflection_amplitudes(float cos_i, const BsdfContext& ctx) const = 0;
};

/// Returns the amplitudes of an interface without absorption; `eta`: index beyond it over the index on the side of the normal.
inline MirrorReflection::Amplitudes dielectric_amplitudes(float cos_i, const Spectrum& eta) {
  MirrorReflection::Amplitudes reflected;
  for (int i = 0; i < kWavelengths; ++i) {
    const auto at = optics::fresnel_amplitudes(double(cos_i), 1, double(eta[i]));
    reflected.s[std::size_t(i)] = at.r_s, reflected.p[std::size_t(i)] = at.r_p;
  }
  return reflected;
}

/// An interface of BSDFs that reflect as another one, which they hold.
class ReflectsAsNested {
public:
  virtual ~ReflectsAsNested() = default;
  /// The BSDF whose reflection it is, from both sides; null: there is none.
  virtual const Bsdf* reflecting() const = 0;
};

/// Returns the interface of the BSDF, or of the one as which it reflects; null if there is none. A BSDF that only stands on another one, such
/// as a coat of paint, has none of that other one.
inline const MirrorReflection* mirror_reflection_of(const Bsdf& bsdf) {
  if (const auto* own = dynamic_cast<const MirrorReflection*>(&bsdf)) return own;
  const auto* wrapper = dynamic_cast<const ReflectsAsNested*>(&bsdf);
  return wrapper && wrapper->reflecting() ? mirror_reflection_of(*wrapper->reflecting()) : nullptr;
}

}  // namespace aureole
