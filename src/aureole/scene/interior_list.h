// SPDX-License-Identifier: Apache-2.0
// `InteriorList`: the nested dielectrics that contain a point, namely closed shapes with a priority (Schmidt
// & Budge 2002, "Simple nested dielectrics in ray traced images"). Where they overlap, the shape with the
// highest priority fills the space, and the surfaces of the others are inactive.
#pragma once

#include "aureole/scene/surface.h"

namespace aureole {

class InteriorList {
public:
  static constexpr int kMaxShapes = 8;  ///< further ones are left out

  /// Returns the surface of the shape that fills the space, ignoring `but`; null if there is none.
  const Surface* filling(const Surface* but = nullptr) const {
    const Surface* found = nullptr;
    for (int i = 0; i < count_; ++i)
      if (inside_[i] != but && (!found || inside_[i]->priority > found->priority)) found = inside_[i];
    return found;
  }
  /// Whether a surface is inactive because a shape of higher priority fills the space. Among equal
  /// priorities, the shape that was entered first fills it.
  bool hides(const Surface& surface) const {
    const Surface* other = filling(&surface);
    return other && (other->priority > surface.priority ||
                     (other->priority == surface.priority && index_of(other) < index_of(&surface)));
  }
  /// Updates the list when the ray crosses a surface into its shape (`inwards`) or out of it.
  void pass(const Surface& surface, bool inwards) {
    const int at = index_of(&surface);
    if (inwards) {
      if (at == count_ && count_ < kMaxShapes) inside_[count_++] = &surface;
    } else if (at < count_) {
      for (int i = at + 1; i < count_; ++i) inside_[i - 1] = inside_[i];
      --count_;
    }
  }
  bool empty() const { return count_ == 0; }

private:
  /// Returns the index of the surface in the list, count_ if it is not there.
  int index_of(const Surface* surface) const {
    int i = 0;
    while (i < count_ && inside_[i] != surface) ++i;
    return i;
  }

  int count_ = 0;
  const Surface* inside_[kMaxShapes];
};

}  // namespace aureole
