// SPDX-License-Identifier: Apache-2.0
// `Spectrum`: one float per wavelength of a path. kWavelengths is a compile-time constant chosen by
// measurement (docs/decisions/0002-eight-wavelengths.md); 8 floats fill one AVX2 register.
#pragma once

#ifdef __AVX__
#include <immintrin.h>
#endif

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

namespace aureole {

#ifndef AUREOLE_WAVELENGTHS
#define AUREOLE_WAVELENGTHS 8
#endif
inline constexpr int kWavelengths = AUREOLE_WAVELENGTHS;
static_assert(kWavelengths == 4 || kWavelengths == 8, "a path carries 4 or 8 wavelengths");

using SpectrumVector = float __attribute__((vector_size(sizeof(float) * kWavelengths)));
using SpectrumMask = int __attribute__((vector_size(sizeof(int) * kWavelengths)));

/// Values at the N wavelengths of a path. Index 0 is the hero wavelength, from which directions are sampled.
struct Spectrum {
  SpectrumVector v;

  Spectrum() : v{} {}
  Spectrum(float s) : v(s - SpectrumVector{}) {}  // NOLINT: scalars are flat spectra
  Spectrum(SpectrumVector vector) : v(vector) {}  // NOLINT

  float& operator[](int i) { return reinterpret_cast<float*>(&v)[i]; }
  float operator[](int i) const { return v[i]; }
  float* data() { return reinterpret_cast<float*>(&v); }
  const float* data() const { return reinterpret_cast<const float*>(&v); }

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
/// Returns a / b where b > 0, zero elsewhere.
inline Spectrum safe_divide(const Spectrum& a, const Spectrum& b) {
  const SpectrumMask positive = b.v > Spectrum(0.f).v;
  return select(positive, a / select(positive, b, 1.f), 0.f);
}
/// Returns the Spectrum of values f(i), i in [0, N).
template <class F>
inline Spectrum make_spectrum(F&& f) {
  Spectrum r;
  for (int i = 0; i < kWavelengths; ++i) r[i] = f(i);
  return r;
}

namespace detail {
/// Reduces the values pairwise, since a chain of N dependent operations would take longer.
template <class F>
inline float reduce(const Spectrum& a, F&& f) {
  float x[kWavelengths];
  for (int i = 0; i < kWavelengths; ++i) x[i] = a.v[i];
  for (int n = kWavelengths / 2; n > 0; n /= 2)
    for (int i = 0; i < n; ++i) x[i] = f(x[i], x[i + n]);
  return x[0];
}
}  // namespace detail

inline float sum(const Spectrum& a) {
  return detail::reduce(a, [](float x, float y) { return x + y; });
}
inline float mean(const Spectrum& a) { return sum(a) * (1.f / kWavelengths); }
inline float max_component(const Spectrum& a) {
  return detail::reduce(a, [](float x, float y) { return x > y ? x : y; });
}
inline float min_component(const Spectrum& a) {
  return detail::reduce(a, [](float x, float y) { return x < y ? x : y; });
}
/// Whether a mask (-1 or 0 per wavelength) is set for at least one wavelength.
inline bool any(const SpectrumMask& m) {
#ifdef __AVX__
  if constexpr (kWavelengths == 8)
    return _mm256_movemask_ps(_mm256_castsi256_ps(reinterpret_cast<const __m256i&>(m))) != 0;
#endif
  std::uint64_t words[sizeof(SpectrumMask) / 8];
  std::memcpy(words, &m, sizeof m);
  std::uint64_t all = 0;
  for (const std::uint64_t w : words) all |= w;
  return all != 0;
}
inline bool is_black(const Spectrum& a) { return !any(a.v != Spectrum(0.f).v); }
/// Whether every value is finite and >= 0, as a radiance must be.
inline bool is_valid_radiance(const Spectrum& a) {
  const SpectrumMask ok = (a.v >= 0) & (a.v <= std::numeric_limits<float>::max());
  return !any(~ok);
}

/// Whether every value is finite.
inline bool is_finite(const Spectrum& a) {
  const SpectrumMask ok = abs(a).v <= std::numeric_limits<float>::max();
  return !any(~ok);
}

}  // namespace aureole
