// SPDX-License-Identifier: Apache-2.0
// Sobol points with a separate dimension per decision, Owen-scrambled by a hash per pixel and dimension. The
// number of dimensions and the scrambling hash may change.
#ifdef __AVX2__
#include <immintrin.h>
#endif

#include <array>
#include <cstring>
#include <initializer_list>

#include "aureole/core/random.h"
#include "aureole/plugin/registry.h"
#include "aureole/sampler/sampler.h"

namespace aureole {
namespace {

constexpr int kDimensions = 256;

struct Directions {
  std::uint32_t polynomial;
  std::array<std::uint32_t, 12> m;
};
constexpr Directions kDirections[kDimensions] = {
#include "aureole/sampler/sobol_directions.inc"
};

constexpr std::uint32_t reverse_bits(std::uint32_t x) {
  x = (x >> 16) | (x << 16);
  x = ((x & 0x00ff00ffu) << 8) | ((x & 0xff00ff00u) >> 8);
  x = ((x & 0x0f0f0f0fu) << 4) | ((x & 0xf0f0f0f0u) >> 4);
  x = ((x & 0x33333333u) << 2) | ((x & 0xccccccccu) >> 2);
  return ((x & 0x55555555u) << 1) | ((x & 0xaaaaaaaau) >> 1);
}

/// The coordinates of 8 dimensions, as 32-bit fractions.
using Block = std::uint32_t __attribute__((vector_size(32)));

/// Generator matrices, for 8 dimensions at a time. They are bit-reversed, because the scrambling works on
/// reversed bits.
struct Matrices {
  Block column[kDimensions / 8][32];

  Matrices() {
    for (int d = 0; d < kDimensions; ++d) {
      std::uint32_t v[32];
      const Directions& t = kDirections[d];
      int degree = 31;
      while (!(t.polynomial >> degree)) --degree;
      for (int i = 0; i < 32; ++i) {
        if (d == 0) {
          v[i] = 1u << (31 - i);  // the first dimension is van der Corput's sequence
        } else if (i < degree) {
          v[i] = t.m[size_t(i)] << (31 - i);
        } else {
          // Recurrence of direction numbers by Bratley & Fox 1988, "Algorithm 659", Eq. 3.
          v[i] = v[i - degree] ^ (v[i - degree] >> degree);
          for (int k = 1; k < degree; ++k)
            if ((t.polynomial >> (degree - k)) & 1) v[i] ^= v[i - k];
        }
        column[d / 8][i][d % 8] = reverse_bits(v[i]);
      }
    }
  }
};
const Matrices& matrices() {
  static const Matrices m;
  return m;
}

Block reverse_bits(Block x) {
#ifdef __AVX2__
  // Reverses the bytes of each number, then the bits of each byte by a table for its halves.
  const __m256i bytes =
      _mm256_shuffle_epi8((__m256i)x, _mm256_setr_epi8(3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12,
                                                       3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12));
  const __m256i reversed =
      _mm256_broadcastsi128_si256(_mm_setr_epi8(0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15));
  const __m256i half = _mm256_set1_epi8(15);
  const __m256i low = _mm256_shuffle_epi8(reversed, _mm256_and_si256(bytes, half));
  const __m256i high = _mm256_shuffle_epi8(reversed, _mm256_and_si256(_mm256_srli_epi16(bytes, 4), half));
  const __m256i r = _mm256_or_si256(_mm256_slli_epi16(low, 4), high);
  return (Block)r;
#else
  for (int i = 0; i < 8; ++i) x[i] = reverse_bits(std::uint32_t(x[i]));
  return x;
#endif
}

/// A hash whose output bits depend only on input bits at or below them. On reversed bits this is a nested
/// uniform (Owen) scramble (Laine & Karras 2011, "Stratified sampling for stochastic transparency"; constants
/// of N. Vegdahl, 2021). It takes one number or a block.
template <class T>
constexpr T owen_hash(T x, T seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

class SobolSampler final : public Sampler {
public:
  explicit SobolSampler(const Properties& p) : Sampler(p), table_(&matrices()) { read_common(p); }

  void block(std::uint64_t pixel_key, std::uint32_t sample, int block, float out[kBlock]) const override {
    constexpr int kBlocks = kDimensions / kBlock;
    // Beyond the table, its dimensions are reused, with the sample index shuffled per repetition (Burley
    // 2020, "Practical hash-based Owen scrambling"). Without the shuffle, repeated dimensions would be
    // correlated with the first ones, and the error would stop decreasing.
    const int repetition = block / kBlocks;
    std::uint32_t index = sample;
    if (repetition > 0)
      index = reverse_bits(owen_hash(reverse_bits(sample),
                                     std::uint32_t(combine_bits(pixel_key, ~std::uint64_t(repetition)))));
    const auto& columns = table_->column[block % kBlocks];
    Block x{};
    for (; index; index &= index - 1) x ^= columns[__builtin_ctz(index)];
    const std::uint32_t key = std::uint32_t(pixel_key) ^ std::uint32_t(pixel_key >> 32);
    // Seeds by a 32-bit hash finaliser (C. Wellons' "lowbias32").
    Block seed = key + 0x9e3779b9u * (std::uint32_t(block * kBlock + 1) + Block{0, 1, 2, 3, 4, 5, 6, 7});
    seed ^= seed >> 16;
    seed *= 0x21f0aaadu;
    seed ^= seed >> 15;
    seed *= 0xd35a2d97u;
    seed ^= seed >> 15;
    using Ints = std::int32_t __attribute__((vector_size(32)));
    using Floats = float __attribute__((vector_size(32)));
    const Ints bits = (Ints)(reverse_bits(owen_hash(x, seed)) >> 8);
    const Floats r = __builtin_convertvector(bits, Floats) * 0x1p-24f;
    std::memcpy(out, &r, sizeof r);
  }

private:
  const Matrices* table_;
};

AUREOLE_PLUGIN(
    SobolSampler, "sampler", "sobol",
    PluginDoc{
        "Sobol points, Owen-scrambled per pixel and dimension: the default. Any number of samples is "
        "possible; powers of two give the lowest error.",
        "Directions: Joe & Kuo 2008. Scrambling: Owen 1995, by hash as in Laine & Karras 2011 and Burley "
        "2020.",
        {},
        {R"(<sampler type="sobol"><integer name="sample_count" value="64"/><integer name="seed" value="1"/>
    <string name="adaptive" value="display"/></sampler>)"}});

}  // namespace
}  // namespace aureole
