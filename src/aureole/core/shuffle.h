// SPDX-License-Identifier: Apache-2.0
// Choice of lanes of a vector of the compiler's vector extension by a vector of indices.
#pragma once

namespace aureole {

/// The vector whose lane i is the lane order[i] of `v`; indices count modulo the number of lanes, a power of two.
template <class Vector, class Order>
Vector shuffle(Vector v, Order order) {
#ifdef __clang__  // which shuffles by constants alone
  constexpr unsigned kLanes = sizeof(Vector) / sizeof(v[0]);
  Vector chosen;
  for (unsigned i = 0; i < kLanes; ++i) chosen[i] = v[unsigned(order[i]) % kLanes];
  return chosen;
#else
  return __builtin_shuffle(v, order);
#endif
}

}  // namespace aureole
