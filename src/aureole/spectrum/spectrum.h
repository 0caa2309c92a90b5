// SPDX-License-Identifier: Apache-2.0
// `Spectrum`: one float per wavelength of a path. kWavelengths is a compile-time constant chosen by
// measurement (docs/decisions.md); 8 floats are one AVX2 register.
#pragma once

#include <cmath>
#include <limits>

namespace aureole {

#ifndef AUREOLE_WAVELENGTHS
#define AUREOLE_WAVELENGTHS 8
#endif
inline constexpr int kWavelengths = AUREOLE_WAVELENGTHS;
static_assert(kWavelengths == 4 || kWavelengths == 8, "a path carries 4 or 8 wavelengths");

using SpectrumVector = float __attribute__((vector_size(sizeof(float) * kWavelengths)));
using SpectrumMask = int __attribute__((vector_size(sizeof(int) * kWavelengths)));

/// Values at the N wavelengths of a path; index 0 is the hero, the wavelength that directions are sampled
/// from.
struct Spectrum {
  SpectrumVector v;

  Spectrum() : v{} {}
  Spectrum(float s) : v(s - SpectrumVector{}) {}  // NOLINT: scalars are flat spectra
  Spectrum(SpectrumVector vector) : v(vector) {}  // NOLINT

  float& operator[](int i) { return reinterpret_cast<float*>(&v)[i]; }
  float operator[](int i) const { return v[i]; }

  Spectrum& operator+=(const Spectrum& b) { return v += b.v, *this; }
  Spectrum& operator-=(const Spectrum& b) { return v -= b.v, *this; }
  Spectrum& operator*=(const Spectrum& b) { return v *= b.v, *this; }
};

inline Spectrum operator+(const Spectrum& a, const Spectrum& b) { return a.v + b.v; }
inline Spectrum operator-(const Spectrum& a, const Spectrum& b) { return a.v - b.v; }
inline Spectrum operator*(const Spectrum& a, const Spectrum& b) { return a.v * b.v; }
inline Spectrum operator/(const Spectrum& a, const Spectrum& b) { return a.v / b.v; }

inline Spectrum select(SpectrumMask m, const Spectrum& a, const Spectrum& b) { return m ? a.v : b.v; }
inline Spectrum max(const Spectrum& a, const Spectrum& b) { return a.v > b.v ? a.v : b.v; }
inline Spectrum min(const Spectrum& a, const Spectrum& b) { return a.v < b.v ? a.v : b.v; }
inline Spectrum abs(const Spectrum& a) { return max(a, Spectrum(-a.v)); }
inline Spectrum lerp(const Spectrum& a, const Spectrum& b, float t) { return a + (b - a) * t; }
inline Spectrum sqrt(const Spectrum& a) {
  Spectrum r;
  for (int i = 0; i < kWavelengths; ++i) r[i] = std::sqrt(a.v[i]);
  return r;
}
/// a / b where b > 0, zero elsewhere.
inline Spectrum safe_divide(const Spectrum& a, const Spectrum& b) {
  const SpectrumMask positive = b.v > Spectrum(0.f).v;
  return select(positive, a / select(positive, b, 1.f), 0.f);
}
/// Spectrum of f(i) for i in [0, N).
template <class F>
inline Spectrum make_spectrum(F&& f) {
  Spectrum r;
  for (int i = 0; i < kWavelengths; ++i) r[i] = f(i);
  return r;
}

inline float sum(const Spectrum& a) {
  float s = 0;
  for (int i = 0; i < kWavelengths; ++i) s += a.v[i];
  return s;
}
inline float mean(const Spectrum& a) { return sum(a) * (1.f / kWavelengths); }
inline float max_component(const Spectrum& a) {
  float m = a.v[0];
  for (int i = 1; i < kWavelengths; ++i) m = a.v[i] > m ? a.v[i] : m;
  return m;
}
inline float min_component(const Spectrum& a) {
  float m = a.v[0];
  for (int i = 1; i < kWavelengths; ++i) m = a.v[i] < m ? a.v[i] : m;
  return m;
}
inline bool is_black(const Spectrum& a) { return max_component(abs(a)) == 0; }
/// True where every value is a finite number >= 0: what a radiance must be.
inline bool is_valid_radiance(const Spectrum& a) {
  const SpectrumMask ok = (a.v >= 0) & (a.v <= std::numeric_limits<float>::max());
  int all = -1;
  for (int i = 0; i < kWavelengths; ++i) all &= ok[i];
  return all != 0;
}

/// The throughput of a path. A type of its own so that polarisation (Mueller matrices) can come.
using Weight = Spectrum;

}  // namespace aureole
