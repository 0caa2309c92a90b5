// SPDX-License-Identifier: Apache-2.0
// `LargeArray`: an array whose random accesses are fast.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <type_traits>

namespace aureole {

/// An array of numbers, zero at first. If it is large, it lies in pages of 2 MB where the system has them: processors keep the
/// addresses of few thousand pages, which cover a few megabytes in pages of 4 kB.
template <class T>
class LargeArray {
  static_assert(std::is_trivial_v<T>);

public:
  LargeArray() = default;
  explicit LargeArray(std::size_t size) : size_(size) {
    constexpr std::size_t kPage = std::size_t(2) << 20, kLine = 64;
    const std::size_t alignment = size >= kPage / sizeof(T) ? kPage : kLine;
    if (size > std::size_t(-1) / sizeof(T) - kPage) throw std::bad_alloc();
    const std::size_t bytes = (size * sizeof(T) + alignment - 1) / alignment * alignment;
    if (bytes == 0) return;
    values_.reset(static_cast<T*>(std::aligned_alloc(alignment, bytes)));
    if (!values_) throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
    if (alignment == kPage) ::madvise(values_.get(), bytes, MADV_HUGEPAGE);  // a hint, which may fail
#endif
    std::memset(values_.get(), 0, bytes);
  }

  T* data() { return values_.get(); }
  const T* data() const { return values_.get(); }
  std::size_t bytes() const { return size_ * sizeof(T); }

private:
  struct Free {
    void operator()(T* p) const { std::free(p); }
  };
  std::size_t size_ = 0;
  std::unique_ptr<T[], Free> values_;
};

}  // namespace aureole
