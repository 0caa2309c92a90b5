// SPDX-License-Identifier: Apache-2.0
// `UnfilledVector`: a std::vector whose new elements have no value until they are written. Large arrays that several
// threads fill need then no earlier pass by one thread, which would also take all page faults.
#pragma once

#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

namespace aureole {

template <class T>
struct UnfilledAllocator : std::allocator<T> {
  static_assert(std::is_trivially_copyable_v<T>);
  template <class U>
  struct rebind {
    using other = UnfilledAllocator<U>;
  };
  template <class U>
  void construct(U*) noexcept {}
  template <class U, class First, class... Rest>
  void construct(U* p, First&& first, Rest&&... rest) {
    std::construct_at(p, std::forward<First>(first), std::forward<Rest>(rest)...);
  }
};

template <class T>
using UnfilledVector = std::vector<T, UnfilledAllocator<T>>;

}  // namespace aureole
