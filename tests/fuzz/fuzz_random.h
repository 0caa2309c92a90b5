// SPDX-License-Identifier: Apache-2.0
// Random decisions of one case: a function of (seed, case) alone.
#pragma once

#include <cstddef>
#include <cstdint>

#include "aureole/core/random.h"

namespace aureole::fuzz {

class Random {
public:
  Random(std::uint64_t seed, std::uint64_t index) : key_(combine_bits(seed, index)) { gentle_ = chance(0.5); }

  std::uint64_t bits() { return combine_bits(key_, counter_++); }
  /// In [0, n); n > 0.
  std::size_t below(std::size_t n) { return std::size_t(bits() % n); }
  double unit() { return double(bits() >> 11) * 0x1p-53; }
  bool chance(double probability) { return unit() < probability; }
  /// 1 with probability 1/2, 2 with 1/4, ..., at most `most`.
  std::size_t few(std::size_t most) {
    std::size_t n = 1;
    while (n < most && chance(0.5)) ++n;
    return n;
  }
  /// In half of the cases values and changes are chosen that scenes might have: most of these render, where
  /// most of the others end at the first error.
  bool is_gentle() const { return gentle_; }

  template <class Container>
  auto& pick(Container& list) {
    return list[below(std::size(list))];
  }

private:
  std::uint64_t key_, counter_ = 0;
  bool gentle_ = false;
};

}  // namespace aureole::fuzz
