// SPDX-License-Identifier: Apache-2.0
// How a table is written to bytes and read back. A type names its members once, for both directions:
//     template <class Self, class Fields>
//     static void fields(Self& self, Fields& all) { all(self.nodes_, self.values_); }
// Members are numbers, enumerations, bool, std::string, std::vector, std::array, std::optional, shared pointers to
// constants, or types with `fields`. Bytes are those of this machine: entries of the cache (table_cache.h) are read by
// the build that has written them, and by no other.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace aureole {

/// The name of a kind of table, and a number that changes with its members or with the computation that fills them.
struct TableKind {
  const char* name;
  int version;
};

/// A type whose objects can be kept on disc: it has a default constructor, `kTable` and `fields`.
template <class T>
concept KeepableTable = requires {
  T::kTable.version;
};

class TableWriter {
public:
  template <class... T>
  void operator()(const T&... members) {
    (put(members), ...);
  }
  std::vector<char>& bytes() { return bytes_; }

private:
  void raw(const void* from, std::size_t size) {
    if (size == 0) return;
    const std::size_t at = bytes_.size();
    bytes_.resize(at + size);
    std::memcpy(bytes_.data() + at, from, size);
  }
  void count(std::size_t n) { put(std::uint64_t(n)); }

  template <class T>
  void put(const T& x) {
    if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>)
      raw(&x, sizeof x);
    else
      T::fields(x, *this);
  }
  template <class T>
  void put(const std::vector<T>& list) {
    count(list.size());
    if constexpr (std::is_arithmetic_v<T>)
      raw(list.data(), list.size() * sizeof(T));
    else
      for (const T& x : list) put(x);
  }
  void put(const std::string& text) { count(text.size()), raw(text.data(), text.size()); }
  template <class T, std::size_t N>
  void put(const std::array<T, N>& list) {
    for (const T& x : list) put(x);
  }
  template <class T, std::size_t N>
  void put(const T (&list)[N]) {
    for (const T& x : list) put(x);
  }
  template <class T>
  void put(const std::optional<T>& x) {
    put(x.has_value());
    if (x) put(*x);
  }
  template <class T>
  void put(const std::shared_ptr<const T>& x) {
    put(x != nullptr);
    if (x) put(*x);
  }

  std::vector<char> bytes_;
};

/// Reads what `TableWriter` has written. Bytes that are no such table are found out by `is_complete`; they never cause
/// an access beyond them or more memory than some times their number.
class TableReader {
public:
  explicit TableReader(std::span<const char> bytes) : bytes_(bytes) {}
  template <class... T>
  void operator()(T&... members) {
    (get(members), ...);
  }
  /// Whether all members were there, and no byte is left.
  bool is_complete() const { return good_ && bytes_.empty(); }

private:
  void raw(void* to, std::size_t size) {
    if (size > bytes_.size()) good_ = false, bytes_ = {};
    if (!good_ || size == 0) return;
    std::memcpy(to, bytes_.data(), size);
    bytes_ = bytes_.subspan(size);
  }
  /// Returns a number of items, each of which takes at least `least_bytes`.
  std::size_t count(std::size_t least_bytes) {
    std::uint64_t n = 0;
    get(n);
    if (n <= bytes_.size() / least_bytes) return std::size_t(n);
    good_ = false, bytes_ = {};
    return 0;
  }

  template <class T>
  void get(T& x) {
    if constexpr (std::is_same_v<T, bool>) {
      unsigned char byte = 0;
      raw(&byte, 1);
      if (byte > 1) good_ = false;
      x = byte == 1;
    } else if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
      raw(&x, sizeof x);
    } else {
      T::fields(x, *this);
    }
  }
  template <class T>
  void get(std::vector<T>& list) {
    constexpr bool kIsPlain = std::is_arithmetic_v<T>;
    list.resize(count(kIsPlain ? sizeof(T) : 1));
    if constexpr (kIsPlain)
      raw(list.data(), list.size() * sizeof(T));
    else
      for (T& x : list) get(x);
  }
  void get(std::string& text) {
    text.resize(count(1));
    raw(text.data(), text.size());
  }
  template <class T, std::size_t N>
  void get(std::array<T, N>& list) {
    for (T& x : list) get(x);
  }
  template <class T, std::size_t N>
  void get(T (&list)[N]) {
    for (T& x : list) get(x);
  }
  template <class T>
  void get(std::optional<T>& x) {
    bool is_there = false;
    get(is_there);
    x.reset();
    if (is_there) get(x.emplace());
  }
  template <class T>
  void get(std::shared_ptr<const T>& x) {
    bool is_there = false;
    get(is_there);
    x.reset();
    if (!is_there) return;
    auto made = std::make_shared<T>();
    get(*made);
    x = std::move(made);
  }

  std::span<const char> bytes_;
  bool good_ = true;
};

}  // namespace aureole
