// SPDX-License-Identifier: Apache-2.0
// `Arena`: memory for the records of paths while an integrator follows a batch of them. Each thread has one, which grows to
// the largest batch that it has followed and is used again for the next batch.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <type_traits>
#include <vector>

namespace aureole {

class Arena {
public:
  Arena(const Arena&) = delete;
  Arena& operator=(const Arena&) = delete;

  /// Memory for `count` records of type T, without a record in it. It is valid until the innermost `Frame` ends.
  template <class T>
  T* allocate(std::size_t count) {
    static_assert(std::is_trivially_destructible_v<T>, "the arena calls no destructors");
    static_assert(alignof(T) <= kAlignment);
    return reinterpret_cast<T*>(allocate_bytes(count * sizeof(T)));  // NOLINT(bugprone-sizeof-expression)
  }
  /// `count` records, made from `arguments`.
  template <class T, class... Arguments>
  std::span<T> make(std::size_t count, const Arguments&... arguments) {
    T* first = allocate<T>(count);
    for (std::size_t i = 0; i < count; ++i) new (first + i) T(arguments...);
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
    ~Frame() { arena_.block_ = block_, arena_.used_ = used_; }
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

  static constexpr std::size_t kAlignment = 64, kBlock = std::size_t(1) << 18;
  struct alignas(kAlignment) Line {
    std::byte bytes[kAlignment];
  };
  struct Block {
    std::unique_ptr<Line[]> lines;
    std::size_t size;  ///< [bytes]
  };

  std::byte* allocate_bytes(std::size_t size) {
    size = (size + kAlignment - 1) / kAlignment * kAlignment;
    while (block_ < blocks_.size() && used_ + size > blocks_[block_].size) ++block_, used_ = 0;
    if (block_ == blocks_.size()) {
      const std::size_t lines = std::max(size, kBlock) / kAlignment;
      blocks_.push_back({std::make_unique_for_overwrite<Line[]>(lines), lines * kAlignment});
    }
    std::byte* const at = blocks_[block_].lines[0].bytes + used_;
    used_ += size;
    return at;
  }

  std::vector<Block> blocks_;
  std::size_t block_ = 0, used_ = 0;  ///< the next free byte: its block, and its offset there
};

}  // namespace aureole
