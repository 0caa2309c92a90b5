// SPDX-License-Identifier: Apache-2.0
// `Arena`: memory for the records of paths while an integrator follows a batch of them. Each thread has one,
// which grows to the largest batch that it has followed and is used again for the next batch.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <type_traits>
#include <vector>

#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/asan_interface.h>
#define AUREOLE_ARENA_POISON(at, size) ASAN_POISON_MEMORY_REGION(at, size)
#define AUREOLE_ARENA_UNPOISON(at, size) ASAN_UNPOISON_MEMORY_REGION(at, size)
#else
#define AUREOLE_ARENA_POISON(at, size) ((void)(at), (void)(size))
#define AUREOLE_ARENA_UNPOISON(at, size) ((void)(at), (void)(size))
#endif

namespace aureole {

class Arena {
public:
  Arena(const Arena&) = delete;
  Arena& operator=(const Arena&) = delete;

  /// Uninitialised memory for `count` records of type T. It is valid until the innermost `Frame` ends.
  template <class T>
  T* allocate(std::size_t count) {
    static_assert(std::is_trivially_destructible_v<T>, "the arena calls no destructors");
    static_assert(alignof(T) <= kAlignment);
    return reinterpret_cast<T*>(allocate_bytes(count * sizeof(T)));  // NOLINT(bugprone-sizeof-expression)
  }
  /// `count` records, made from `arguments`; without any, members that have no initialiser are not initialised.
  template <class T, class... Arguments>
  std::span<T> make(std::size_t count, const Arguments&... arguments) {
    T* first = allocate<T>(count);
    for (std::size_t i = 0; i < count; ++i) {
      if constexpr (sizeof...(arguments) == 0)
        new (first + i) T;  // T() would clear all of it first
      else
        new (first + i) T(arguments...);
    }
    return {first, count};
  }

  /// Gives back what was allocated during its life. Frames are nested: an integrator within another one begins a
  /// frame of its own.
  class Frame {
  public:
    /// Begins a frame of the arena of the calling thread.
    Frame() : arena_(of_thread()), block_(arena_.block_), used_(arena_.used_) {}
    Frame(const Frame&) = delete;
    Frame& operator=(const Frame&) = delete;
    ~Frame() { arena_.give_back(block_, used_); }
    Arena& arena() const { return arena_; }

  private:
    Arena& arena_;
    std::size_t block_, used_;
  };

private:
  Arena() = default;
  static Arena& of_thread() {
    static thread_local Arena arena;
    return arena;
  }

#ifdef __SANITIZE_ADDRESS__
  static constexpr bool kIsWatched = true;
#else
  static constexpr bool kIsWatched = false;
#endif
  static constexpr std::size_t kAlignment = 64, kBlock = std::size_t(1) << 18;
  struct alignas(kAlignment) Line {
    std::byte bytes[kAlignment];
  };
  struct Block {
    std::unique_ptr<Line[]> lines;
    std::size_t size;  ///< [bytes]
  };

  std::byte* allocate_bytes(std::size_t size) {
    // At least a line between records where AddressSanitizer looks for accesses outside of them.
    const std::size_t whole =
        (size + kAlignment - 1 + (kIsWatched ? kAlignment : 0)) / kAlignment * kAlignment;
    while (block_ < blocks_.size() && used_ + whole > blocks_[block_].size) ++block_, used_ = 0;
    if (block_ == blocks_.size()) {
      const std::size_t lines = std::max(whole, kBlock) / kAlignment;
      blocks_.push_back({std::make_unique_for_overwrite<Line[]>(lines), lines * kAlignment});
      AUREOLE_ARENA_POISON(bytes_of(block_), lines * kAlignment);
    }
    std::byte* const at = bytes_of(block_) + used_;
    used_ += whole;
    AUREOLE_ARENA_UNPOISON(at, size);
    return at;
  }
  void give_back(std::size_t block, std::size_t used) {
    for (std::size_t i = block; i < blocks_.size() && i <= block_; ++i) {
      const std::size_t from = i == block ? used : 0;
      AUREOLE_ARENA_POISON(bytes_of(i) + from, blocks_[i].size - from);
    }
    block_ = block, used_ = used;
  }
  std::byte* bytes_of(std::size_t block) { return reinterpret_cast<std::byte*>(blocks_[block].lines.get()); }

  std::vector<Block> blocks_;
  std::size_t block_ = 0, used_ = 0;  ///< the next free byte: its block, and its offset there
};

}  // namespace aureole
