// SPDX-License-Identifier: Apache-2.0
// Counter-based random numbers: each is a function of (seed, pixel or path, sample, dimension), so that a
// picture does not depend on threads, order or interruptions.
#pragma once

#include <cstdint>

namespace aureole {

/// The finaliser of SplitMix64 (Steele, Lea & Flood 2014, "Fast splittable pseudorandom number generators"):
/// a bijection of 64-bit numbers.
constexpr std::uint64_t mix_bits(std::uint64_t x) {
  x ^= x >> 30;
  x *= 0xbf58476d1ce4e5b9u;
  x ^= x >> 27;
  x *= 0x94d049bb133111ebu;
  x ^= x >> 31;
  return x;
}

constexpr std::uint64_t combine_bits(std::uint64_t a, std::uint64_t b) {
  return mix_bits(a + 0x9e3779b97f4a7c15u * (b + 1));
}

/// Converts 24 random bits to a float in [0, 1).
constexpr float unit_float(std::uint32_t bits) { return float(bits >> 8) * 0x1p-24f; }

}  // namespace aureole
