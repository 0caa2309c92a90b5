// SPDX-License-Identifier: Apache-2.0
#include "aureole/integrator/splat/depth_sort.h"

#include <algorithm>
#include <array>
#include <bit>
#include <vector>

#include "aureole/core/parallel.h"

namespace aureole {

namespace {

/// A radix sort from the least significant digit: three digits of 11 bits of a 32-bit key.
constexpr int kDigitBits = 11, kDigits = 3;
constexpr std::uint32_t kDigitValues = 1 << kDigitBits;

struct DepthEntry {
  std::uint32_t key, index;
};

}  // namespace

UnfilledVector<std::uint32_t> sort_by_depth(std::span<const float> depths) {
  const std::size_t n = depths.size();
  // Parts of the array are counted and distributed independently; the result does not depend on their number.
  const std::size_t parts = std::clamp<std::size_t>(n >> 14, 1, 32), length = (n + parts - 1) / parts;
  UnfilledVector<DepthEntry> from(n), to(n);
  std::vector<std::array<std::uint32_t, kDigitValues>> counts(parts);
  const auto for_parts = [&](const auto& body) {
    for_ranges(
        parts,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t p = begin; p < end; ++p)
            body(p, std::min(n, p * length), std::min(n, (p + 1) * length));
        },
        1);
  };
  for_parts([&](std::size_t, std::size_t begin, std::size_t end) {
    // The bits of positive floats, read as integers, have the order of the numbers.
    for (std::size_t i = begin; i < end; ++i)
      from[i] = {std::bit_cast<std::uint32_t>(depths[i]), std::uint32_t(i)};
  });
  for (int digit = 0; digit < kDigits; ++digit) {
    const int shift = digit * kDigitBits;
    const auto value = [&](const DepthEntry& e) { return e.key >> shift & (kDigitValues - 1); };
    for_parts([&](std::size_t p, std::size_t begin, std::size_t end) {
      counts[p].fill(0);
      for (std::size_t i = begin; i < end; ++i) ++counts[p][value(from[i])];
    });
    std::uint32_t sum = 0;
    for (std::uint32_t v = 0; v < kDigitValues; ++v)
      for (auto& count : counts) {
        const std::uint32_t here = count[v];
        count[v] = sum;
        sum += here;
      }
    for_parts([&](std::size_t p, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) to[counts[p][value(from[i])]++] = from[i];
    });
    std::swap(from, to);
  }
  UnfilledVector<std::uint32_t> order(n);
  for_parts([&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) order[i] = from[i].index;
  });
  return order;
}

}  // namespace aureole
