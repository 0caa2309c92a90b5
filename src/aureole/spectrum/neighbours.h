// SPDX-License-Identifier: Apache-2.0
// Look-ups in a row of a table over wavelengths, for linear interpolation between its nodes.
#pragma once

#ifdef __AVX2__
#include <immintrin.h>
#endif

#include <cstring>

#include "aureole/spectrum/spectrum.h"

namespace aureole {

/// The table's values at the nodes at[j] and at[j] + 1 for each wavelength j; each pair is read by one load.
struct Neighbours {
  Spectrum first, second;
  Neighbours(const float* table, const int (&at)[kWavelengths]) {
#ifdef __AVX2__
    if constexpr (kWavelengths == 8) {
      const auto two = [&](int j) {
        long long bits;
        std::memcpy(&bits, table + at[j], sizeof bits);
        return bits;
      };
      const auto four = [&](int j) { return _mm_castsi128_ps(_mm_set_epi64x(two(j + 1), two(j))); };
      const __m256 low = _mm256_set_m128(four(4), four(0)), high = _mm256_set_m128(four(6), four(2));
      const __m256 a = _mm256_shuffle_ps(low, high, _MM_SHUFFLE(2, 0, 2, 0));
      const __m256 b = _mm256_shuffle_ps(low, high, _MM_SHUFFLE(3, 1, 3, 1));
      first = reinterpret_cast<const SpectrumVector&>(a), second = reinterpret_cast<const SpectrumVector&>(b);
      return;
    }
#endif
    for (int j = 0; j < kWavelengths; ++j) first[j] = table[at[j]], second[j] = table[at[j] + 1];
  }
  /// Interpolates linearly between this row (t = 0) and `other` (t = 1).
  void mix(const Neighbours& other, float t) {
    first = lerp(first, other.first, t), second = lerp(second, other.second, t);
  }
};

}  // namespace aureole
