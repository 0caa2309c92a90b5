// SPDX-License-Identifier: Apache-2.0
// Fresnel reflectances in single precision for the renderer's inner loop: unpolarised light, arguments not
// checked, no division by values that may be zero. `optics/interface/fresnel_equations.h` has the equations
// in double precision; tests compare both.
#pragma once

#include <algorithm>
#include <cmath>

#include "aureole/spectrum/spectrum.h"

namespace aureole {

struct DielectricFresnel {
  float reflectance = 1;  ///< reflectance; 1 beyond the critical angle
  float cos_t = 0;        ///< cosine of the transmitted direction, positive; 0 beyond the critical angle
};

/// Reflectance for light from a medium of index n_i that hits a medium of index n_t; eta = n_t/n_i, cos_i in
/// (0, 1]. Born & Wolf, Principles of Optics, 7th ed. 1999, 1.5.2 equation 21, written with g = eta cos_t =
/// sqrt(eta^2 - 1 + cos_i^2). This is exact for matched indices and loses no precision near the critical
/// angle.
inline DielectricFresnel fresnel_dielectric(float cos_i, float eta) {
  const float g2 = (eta - 1) * (eta + 1) + cos_i * cos_i;
  if (!(g2 > 0)) return {};
  const float g = std::sqrt(g2), e = eta * eta * cos_i;
  const float r_s = (cos_i - g) / (cos_i + g), r_p = (e - g) / (e + g);
  return {std::min(0.5f * (r_s * r_s + r_p * r_p), 1.f), std::min(g / eta, 1.f)};
}

/// Returns the reflectance alone, per wavelength. It takes one eta, or one per wavelength, and, with
/// microfacets, one cosine per wavelength.
inline Spectrum fresnel_dielectric(const Spectrum& cos_i, const Spectrum& eta) {
  const Spectrum g2 = (eta - 1.f) * (eta + 1.f) + cos_i * cos_i;
  const SpectrumMask refracts = g2.v > Spectrum(0.f).v;
  const Spectrum g = sqrt(select(refracts, g2, 1.f)), e = eta * eta * cos_i;
  const Spectrum r_s = (cos_i - g) / (cos_i + g), r_p = (e - g) / (e + g);
  return select(refracts, min(Spectrum(0.5f) * (r_s * r_s + r_p * r_p), 1.f), 1.f);
}

/// Reflectance for light from vacuum that hits a conductor of index eta + i k. Born & Wolf 1999, section
/// 14.2: with a + i b the root of (eta + i k)^2 - sin_i^2, the amplitudes are r_s = (cos_i - a - i b)/(cos_i
/// + a + i b) and r_p = r_s (a + i b - sin_i tan_i)/(a + i b + sin_i tan_i). Their powers are sums of
/// squares, without cancellation.
inline Spectrum fresnel_conductor(float cos_i, const Spectrum& eta, const Spectrum& k) {
  const float c2 = cos_i * cos_i, s2 = (1 - cos_i) * (1 + cos_i);
  const Spectrum real = (eta - 1.f) * (eta + 1.f) - k * k + c2, half_imaginary = eta * k;
  const Spectrum modulus = sqrt(real * real + Spectrum(4.f) * half_imaginary * half_imaginary);
  const Spectrum p = sqrt(Spectrum(0.5f) * (modulus + abs(real)));
  const Spectrum q = half_imaginary / max(p, 1e-30f);  // p is 0 only where the root is 0
  const SpectrumMask positive = real.v > Spectrum(0.f).v;
  const Spectrum a = select(positive, p, q), b = select(positive, q, p), b2 = b * b;
  const Spectrum minus = a - cos_i, plus = a + cos_i;
  const Spectrum r_s = (minus * minus + b2) / max(plus * plus + b2, 1e-30f);
  const Spectrum ac = a * cos_i, pm = ac - s2, pp = ac + s2;
  const Spectrum r_p = r_s * (pm * pm + b2 * c2) / max(pp * pp + b2 * c2, 1e-30f);
  return min(Spectrum(0.5f) * (r_s + r_p), 1.f);
}

/// Returns the reflectance of a lossless slab with all its interreflections, from the reflectance R of one
/// face: R + T^2 R + ... = 2R/(1 + R).
inline float thin_slab(float r) { return 2 * r / (1 + r); }
inline Spectrum thin_slab(const Spectrum& r) { return Spectrum(2.f) * r / (Spectrum(1.f) + r); }

}  // namespace aureole
