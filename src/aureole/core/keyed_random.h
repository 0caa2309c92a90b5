// SPDX-License-Identifier: Apache-2.0
// `KeyedRandom`: random numbers for decisions that need an unlimited number of them (docs/conventions.md,
// "Random numbers").
#pragma once

#include "aureole/core/random.h"

namespace aureole {

/// A sequence of numbers in [0, 1) determined by a key.
class KeyedRandom {
public:
  explicit KeyedRandom(std::uint32_t key) : state_(mix_bits(key + 0x9e3779b97f4a7c15u)) {}
  float next() { return unit_float(std::uint32_t(mix_bits(state_ += 0x9e3779b97f4a7c15u) >> 32)); }

private:
  std::uint64_t state_;
};

}  // namespace aureole
