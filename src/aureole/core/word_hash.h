// SPDX-License-Identifier: Apache-2.0
// Hashes of content: of scenes, of elements and of the inputs of tables. They tell apart what differs by chance; they
// are not made to withstand somebody who looks for two contents with one hash.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace aureole {

/// FNV-1a over 64-bit words instead of bytes, for files of many megabytes. A final mix follows, because
/// multiplication propagates nothing from high to low bits. Hashes with different factors are independent.
template <std::uint64_t kFactor = 0x100000001b3u>
class WordHash {
public:
  void bytes(const char* data, std::size_t size) {
    number(size);
    for (; size >= 8; data += 8, size -= 8) {
      std::uint64_t w;
      std::memcpy(&w, data, 8);
      number(w);
    }
    std::uint64_t rest = 0;
    std::memcpy(&rest, data, size);
    number(rest);
  }
  void text(std::string_view s) { bytes(s.data(), s.size()); }
  void number(std::uint64_t w) { state_ = ((state_ ^ w) * kFactor) ^ (state_ >> 29); }

  std::uint64_t value() const {
    std::uint64_t h = state_;
    h = (h ^ (h >> 32)) * 0xd6e8feb86659fd93u;
    return h ^ (h >> 32);
  }

private:
  std::uint64_t state_ = 0xcbf29ce484222325u;
};

/// A hash of 128 bits.
using WideHashValue = std::array<std::uint64_t, 2>;

/// Two independent hashes of the same content, for keys of tables that are kept for years: among 10^9 contents two of
/// them share a hash with a probability of about 10^-21.
class WideHash {
public:
  void bytes(const char* data, std::size_t size) { first_.bytes(data, size), second_.bytes(data, size); }
  void text(std::string_view s) { bytes(s.data(), s.size()); }
  void number(std::uint64_t w) { first_.number(w), second_.number(w); }
  void wide(const WideHashValue& value) { number(value[0]), number(value[1]); }
  WideHashValue value() const { return {first_.value(), second_.value()}; }

private:
  WordHash<> first_;
  WordHash<0x9e3779b97f4a7c15u> second_;
};

}  // namespace aureole
