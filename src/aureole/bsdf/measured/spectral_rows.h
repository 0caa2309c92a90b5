// SPDX-License-Identifier: Apache-2.0
// Spectra of a large measured table, stored so that an evaluation reads few cache lines: half-precision numbers in an order
// in which the wavelengths of one path are neighbours.
#pragma once

#ifdef __F16C__
#include <immintrin.h>
#endif

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "aureole/bsdf/measured/spectral_nodes.h"
#include "aureole/core/large_array.h"
#include "aureole/core/shuffle.h"

namespace aureole {

/// A row of numbers, one for each wavelength of the table, for each of many nodes. A path's wavelengths are equidistant in the
/// CDF of the density that a scene chooses. Numbers are ordered by the position of their wavelengths between two
/// neighbours of such a set, for the density of a colour film; so the numbers of a set lie together. Other densities
/// need more cache lines and give the same values.
class SpectralRows {
public:
  SpectralRows() = default;
  /// `maximum`: the largest magnitude of the numbers that will be stored.
  SpectralRows(const SpectralGrid& grid, const SpectralNodes& nodes, std::size_t rows, float maximum);

  /// Stores the numbers of a row, in the order of the wavelengths used.
  void set(std::size_t row, std::span<const float> values);

  /// The four rows around a point of a rectangular table: `row`, the next one, and those `width` rows behind.
  struct Corners {
    std::size_t width;
    float s, t;  ///< position towards the next row and towards the rows behind, in [0, 1]
  };
  /// Returns the sum over `count` of weight[k] times the bilinear interpolation around rows[k], at the wavelengths of a path.
  template <int count>
  Spectrum sum(const std::uint32_t* rows, const float* weight, const Corners& corners,
               const SpectralNodes::Place& place) const {
    Slots slots(*this, place);
    Spectrum low(0.f), high(0.f);
    std::array<const Stored*, std::size_t(count)> base;
    std::array<std::array<float, 4>, std::size_t(count)> factor;
    for (std::size_t k = 0; k < std::size_t(count); ++k) {
      base[k] = values_.data() + rows[k] * stride_;
      const float left = weight[k] * (1 - corners.s), right = weight[k] * corners.s;
      factor[k] = {left * (1 - corners.t), right * (1 - corners.t), left * corners.t, right * corners.t};
    }
    const std::size_t behind = corners.width * stride_;
    slots.for_each_block([&](int first) __attribute__((always_inline)) {
      Spectrum a(0.f), b(0.f);
      for (std::size_t k = 0; k < std::size_t(count); ++k) {
        const Stored* const p = base[k] + first;
        a += load(p) * factor[k][0] + load(p + stride_) * factor[k][1];
        b += load(p + behind) * factor[k][2] + load(p + behind + stride_) * factor[k][3];
      }
      a += b;
      low += pick(a, slots.low - first), high += pick(a, slots.high - first);
    });
    return (low + (high - low) * place.fraction) * unit_;
  }

  std::size_t bytes() const { return values_.bytes(); }

private:
#ifdef __F16C__
  using Stored = std::uint16_t;  ///< bits of a number in half precision (IEEE 754)
  static Spectrum load(const Stored* p) {
    if constexpr (kWavelengths == 8) {
      const __m256 r = _mm256_cvtph_ps(_mm_loadu_si128(reinterpret_cast<const __m128i*>(p)));
      return Spectrum(reinterpret_cast<const SpectrumVector&>(r));
    } else {
      const __m128 r = _mm_cvtph_ps(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(p)));
      return Spectrum(reinterpret_cast<const SpectrumVector&>(r));
    }
  }
#else
  using Stored = float;  // the processor does not convert numbers in half precision
  static Spectrum load(const Stored* p) {
    Spectrum s;
    std::memcpy(s.data(), p, sizeof s);
    return s;
  }
#endif

  static Spectrum pick(const Spectrum& values, SpectrumMask index) {
    const SpectrumMask is_inside = (index >= 0) & (index < kWavelengths);
    return is_inside ? shuffle(values.v, index) : Spectrum(0.f).v;
  }

  /// The slots of the wavelengths around those of a path, and the blocks of kWavelengths slots that contain them.
  struct Slots {
    Slots(const SpectralRows& rows, const SpectralNodes::Place& place) : words(rows.words_) {
      const SlotPair* const pairs = rows.pairs_.data();
      for (int j = 0; j < kWavelengths; ++j) {
        const SlotPair pair = pairs[place.index[j]];
        low[j] = pair.low, high[j] = pair.high;
        mask |= pair.blocks;
      }
    }
    template <class Visit>
    void for_each_block(const Visit& visit) const {
      if (words == 1) {
        for (std::uint64_t left = mask; left; left &= left - 1) visit(std::countr_zero(left) * kWavelengths);
        return;
      }
      // Tables of more than 64 blocks: a bit stands for blocks that are `words` blocks apart.
      for (int block = 0; block < 64 * words; ++block)
        if (mask >> (block % 64) & 1) visit_if_used(block * kWavelengths, visit);
    }
    template <class Visit>
    void visit_if_used(int first, const Visit& visit) const {
      for (int j = 0; j < kWavelengths; ++j)
        if (unsigned(low[j] - first) < unsigned(kWavelengths) ||
            unsigned(high[j] - first) < unsigned(kWavelengths))
          return visit(first);
    }
    SpectrumMask low, high;
    std::uint64_t mask = 0;
    int words;
  };
  /// For an interval of wavelengths: the slots of both ends, and bits of their blocks.
  struct SlotPair {
    std::uint64_t blocks;
    std::int32_t low, high;
  };

  std::size_t stride_ = 0;  ///< number of slots of a row, a multiple of kWavelengths
  int words_ = 1;           ///< number of 64 blocks in a row, rounded up
  float unit_ = 1;          ///< stored numbers times this are the numbers of the table
  std::vector<std::int32_t> slot_;
  std::vector<SlotPair> pairs_;
  LargeArray<Stored> values_;
};

}  // namespace aureole
