// SPDX-License-Identifier: Apache-2.0
// Positions of a path's wavelengths among the wavelengths of a measured table.
#pragma once

#ifdef __AVX2__
#include <immintrin.h>
#endif

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "aureole/core/shuffle.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

/// The wavelengths of a table that matter to the scene's grid: those within its range and the nearest ones outside.
class SpectralNodes {
public:
  SpectralNodes() = default;
  /// `nm` increases and is not empty.
  SpectralNodes(const SpectralGrid& grid, std::span<const float> nm);

  std::size_t first() const { return first_; }  ///< index of the first node that is used
  /// Number of nodes used, 2 or more: where a single wavelength of the table is used, its values are stored
  /// twice.
  std::size_t count() const { return nm_.size(); }
  std::span<const float> nm() const { return nm_; }  ///< wavelengths of the nodes used
  /// Index in the table of the i-th node used.
  std::size_t source(std::size_t i) const { return first_ + (is_single_ ? 0 : i); }

  /// For each wavelength of a path the index of the node below and the position towards the next one, in [0, 1].
  /// Wavelengths outside of the table are clamped to the nearest node.
  struct Place {
    std::int32_t index[kWavelengths];
    Spectrum fraction;
  };
  Place at(const Wavelengths& w) const {
    Place p;
    if (is_even_) {
      // Gathering from tables would take longer than all else here.
      const Spectrum scaled = min(max((w.nm - nm_[0]) * inverse_step_[0], 0.f), float(inverse_step_.size()));
      const SpectrumMask last = int(inverse_step_.size()) - 1 - SpectrumMask{},
                         below = __builtin_convertvector(scaled.v, SpectrumMask),
                         index = below < last ? below : last;
      std::memcpy(p.index, &index, sizeof index);
      p.fraction = scaled - Spectrum(__builtin_convertvector(index, SpectrumVector));
      return p;
    }
    const std::int32_t* const guess = guess_.data();
    const float* const bound = bound_.data();
    for (int j = 0; j < kWavelengths; ++j)
      p.index[j] = guess[w.cell[j]] + (w.nm.v[j] >= bound[w.cell[j]] ? 1 : 0);
    if (cells_hold_several_) {
      const int last = int(nm_.size()) - 2;
      for (int j = 0; j < kWavelengths; ++j)
        while (p.index[j] < last && w.nm[j] >= nm_[std::size_t(p.index[j]) + 1]) ++p.index[j];
    }
    const float *const nm = nm_.data(), *const inverse_step = inverse_step_.data();
    for (int j = 0; j < kWavelengths; ++j)
      p.fraction[j] = (w.nm.v[j] - nm[p.index[j]]) * inverse_step[p.index[j]];
    p.fraction = min(max(p.fraction, 0.f), 1.f);
    return p;
  }

private:
  std::size_t first_ = 0;
  bool is_single_ = false;
  bool is_even_ = false;  ///< whether nodes are equidistant but for the rounding of their wavelengths
  std::vector<float> nm_, inverse_step_;
  bool cells_hold_several_ = false;  ///< whether some cell of the grid contains more than one node
  std::vector<std::int32_t> guess_;  ///< for each cell of the grid, the node at or below its lower end
  std::vector<float> bound_;         ///< for each cell, the next node, or infinity after the last interval
};

/// A weighted sum of the spectra at nodes of a table, each a row of values at the wavelengths used.
class SpectralSum {
public:
  explicit SpectralSum(const SpectralNodes::Place& place) : place_(place) {}

  void add(const float* row, float weight) {
#ifdef __AVX2__
    if constexpr (kWavelengths == 8) {
      // Loads both values around a wavelength at once; they are separated at the end.
      const auto both = [&](int j) {
        long long two;
        std::memcpy(&two, row + place_.index[j], sizeof two);
        return two;
      };
      const auto pair = [&](int j) { return _mm_castsi128_ps(_mm_set_epi64x(both(j + 1), both(j))); };
      const __m256 w = _mm256_set1_ps(weight);
      low_ = _mm256_fmadd_ps(_mm256_set_m128(pair(4), pair(0)), w, low_);
      high_ = _mm256_fmadd_ps(_mm256_set_m128(pair(6), pair(2)), w, high_);
      return;
    }
#endif
    for (int j = 0; j < kWavelengths; ++j) {
      below_[j] += weight * row[place_.index[j]];
      above_[j] += weight * row[place_.index[j] + 1];
    }
  }

  Spectrum value() const {
#ifdef __AVX2__
    if constexpr (kWavelengths == 8) {
      const __m256 a = _mm256_shuffle_ps(low_, high_, _MM_SHUFFLE(2, 0, 2, 0));
      const __m256 b = _mm256_shuffle_ps(low_, high_, _MM_SHUFFLE(3, 1, 3, 1));
      const __m256 t = reinterpret_cast<const __m256&>(place_.fraction.v);
      const __m256 r = _mm256_fmadd_ps(_mm256_sub_ps(b, a), t, a);
      return Spectrum(reinterpret_cast<const SpectrumVector&>(r));
    }
#endif
    return below_ + (above_ - below_) * place_.fraction;
  }

private:
  const SpectralNodes::Place& place_;
#ifdef __AVX2__
  __m256 low_ = _mm256_setzero_ps(), high_ = _mm256_setzero_ps();
#endif
  Spectrum below_{0.f}, above_{0.f};
};

/// The spectrum of a path's wavelengths, from a row of values that is given in parts of kWavelengths values each, which stay in
/// registers. For tables with few wavelengths.
class RegisterSum {
public:
  explicit RegisterSum(const SpectralNodes::Place& place) : fraction_(place.fraction) {
    std::memcpy(&index_, place.index, sizeof index_);
  }

  /// The values of the row from the wavelength of index `first` on.
  void add(const Spectrum& values, int first) {
    below_ += pick(values, index_ - first);
    above_ += pick(values, index_ + 1 - first);
  }
  Spectrum value() const { return below_ + (above_ - below_) * fraction_; }

private:
  static Spectrum pick(const Spectrum& values, SpectrumMask index) {
    const SpectrumMask is_inside = (index >= 0) & (index < kWavelengths);
    return is_inside ? shuffle(values.v, index) : Spectrum(0.f).v;
  }

  SpectrumMask index_;
  Spectrum fraction_, below_{0.f}, above_{0.f};
};

}  // namespace aureole
