// SPDX-License-Identifier: Apache-2.0
// Four double-precision numbers in one vector, with sines, cosines and exponentials.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

namespace aureole::optics {

inline constexpr int kLanes = 4;
using Lanes [[gnu::vector_size(kLanes * sizeof(double))]] = double;
using LaneBits [[gnu::vector_size(kLanes * sizeof(double))]] = std::int64_t;
using UnsignedLaneBits [[gnu::vector_size(kLanes * sizeof(double))]] = std::uint64_t;

inline Lanes load_lanes(const double* p) {
  Lanes v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
inline void store_lanes(double* p, const Lanes& v) { std::memcpy(p, &v, sizeof v); }

inline Lanes square_root(const Lanes& x) {
  Lanes root;
  for (int i = 0; i < kLanes; ++i) root[i] = std::sqrt(x[i]);
  return root;
}

/// Returns the lanes in which a comparison is true: bit i is that of lane i.
inline unsigned lanes_of(const LaneBits& comparison) {
#ifdef __AVX__
  Lanes signs;
  std::memcpy(&signs, &comparison, sizeof signs);
  return unsigned(__builtin_ia32_movmskpd256(signs));
#else
  unsigned bits = 0;
  for (int i = 0; i < kLanes; ++i) bits |= comparison[i] ? 1u << i : 0;
  return bits;
#endif
}

/// Computes sine and cosine with errors near 2e-16 for |x| < 1e15. A multiple of pi/2 is subtracted in two
/// parts; Taylor series cover the rest, up to pi/4.
inline void sine_cosine(const Lanes& x, Lanes& sine, Lanes& cosine) {
  constexpr double kRound = 0x1.8p52;  // adding it leaves an integer in the last bits
  const Lanes shifted = x * 0.63661977236758134308 + kRound;
  const Lanes n = shifted - kRound;
  LaneBits quadrant;
  std::memcpy(&quadrant, &shifted, sizeof quadrant);
  Lanes r = x - n * 1.57079632679489655800;
  r = r - n * 6.12323399573676603587e-17;
  const Lanes r2 = r * r;
  Lanes s = r2 * (-1 / 1307674368000.0) + 1 / 6227020800.0;
  s = s * r2 - 1 / 39916800.0;
  s = s * r2 + 1 / 362880.0;
  s = s * r2 - 1 / 5040.0;
  s = s * r2 + 1 / 120.0;
  s = s * r2 - 1 / 6.0;
  s = s * r2 * r + r;
  Lanes c = r2 * (1 / 20922789888000.0) - 1 / 87178291200.0;
  c = c * r2 + 1 / 479001600.0;
  c = c * r2 - 1 / 3628800.0;
  c = c * r2 + 1 / 40320.0;
  c = c * r2 - 1 / 720.0;
  c = c * r2 + 1 / 24.0;
  c = c * r2 - 0.5;
  c = c * r2 + 1;
  const LaneBits odd = (quadrant & 1) != 0;
  const Lanes a = odd ? c : s, b = odd ? s : c;
  sine = (quadrant & 2) != 0 ? -a : a;
  cosine = ((quadrant + 1) & 2) != 0 ? -b : b;
}

/// Returns exp(-x) for x >= 0 with a relative error of 4e-16; 0 beyond 700.
inline Lanes exp_minus(const Lanes& x) {
  constexpr double kRound = 0x1.8p52;
  const Lanes shifted = x * -1.4426950408889634074 + kRound;
  const Lanes n = shifted - kRound;
  UnsignedLaneBits power;
  std::memcpy(&power, &shifted, sizeof power);
  // -x minus n ln 2, at most ln(2)/2 in magnitude, in two parts.
  Lanes r = -x - n * 0x1.62e42fefa39efp-1;
  r = r - n * 0x1.abc9e3b39803fp-56;
  // Taylor series of exp.
  Lanes e = r * (1 / 6227020800.0) + 1 / 479001600.0;
  e = e * r + 1 / 39916800.0;
  e = e * r + 1 / 3628800.0;
  e = e * r + 1 / 362880.0;
  e = e * r + 1 / 40320.0;
  e = e * r + 1 / 5040.0;
  e = e * r + 1 / 720.0;
  e = e * r + 1 / 120.0;
  e = e * r + 1 / 24.0;
  e = e * r + 1 / 6.0;
  e = e * r + 0.5;
  e = e * r + 1;
  e = e * r + 1;
  UnsignedLaneBits bits;  // the sum of the exponents may wrap where x is beyond 700
  std::memcpy(&bits, &e, sizeof bits);
  bits += power << 52;
  std::memcpy(&e, &bits, sizeof e);
  return x < 700.0 ? e : Lanes{};
}
/// Returns 1 - exp(-x) for x >= 0.
inline Lanes one_less_exp_minus(const Lanes& x) { return x < 1e-5 ? x - 0.5 * x * x : 1 - exp_minus(x); }

}  // namespace aureole::optics
