// SPDX-License-Identifier: Apache-2.0
// `InteriorList`: the nested dielectrics that contain a point, namely closed bodies with a rank (Schmidt &
// Budge 2002, "Simple nested dielectrics in ray traced images"). Where they overlap, the body with the
// highest rank fills the space, and the surfaces of the other bodies are inactive.
#pragma once

#include "aureole/scene/surface.h"

namespace aureole {

class InteriorList {
public:
  /// upper bound of the number of bodies; additional bodies are ignored
  static constexpr int kMaxBodies = 8;

  /// A body, identified by one of its surfaces. Instances of a group share the group's surfaces.
  struct Body {
    const Surface* surface = nullptr;
    const Instance* instance = nullptr;

    /// Whether the body determines the medium within it. A body without a medium is filled by the medium
    /// around it or, with a stated priority, by vacuum.
    bool decides_medium() const { return surface && (surface->rank > 0 || surface->bounds_media); }
    bool operator==(const Body& other) const {
      return surface && other.surface && surface->body == other.surface->body && instance == other.instance;
    }
  };

  /// Returns the body that fills the space, ignoring `but`; its surface is null if there is none.
  Body filling() const { return filling(Body{}); }
  Body filling(const Body& but) const {
    Body found;
    for (int i = 0; i < count_; ++i)
      if (!(inside_[i] == but) && (!found.surface || is_above(inside_[i], found))) found = inside_[i];
    return found;
  }
  /// Whether the surfaces of a body are inactive because another one of higher rank fills the space.
  bool hides(const Body& body) const {
    const Body other = filling(body);
    return other.surface && is_above(other, body);
  }
  bool contains(const Body& body) const { return index_of(body) < count_; }
  /// Updates the list when the ray crosses a surface of a body into it (`inwards`) or out of it.
  void pass(const Body& body, bool inwards) {
    const int at = index_of(body);
    if (inwards) {
      if (at == count_ && count_ < kMaxBodies) inside_[count_++] = body;
    } else if (at < count_) {
      for (int i = at + 1; i < count_; ++i) inside_[i - 1] = inside_[i];
      --count_;
    }
  }
  bool empty() const { return count_ == 0; }

private:
  /// Whether body `a` takes precedence over `b`. Among equal ranks, such as equal priorities, the body of the
  /// smaller number fills the space, and of two instances the one that was entered first.
  bool is_above(const Body& a, const Body& b) const {
    if (a.surface->rank != b.surface->rank) return a.surface->rank > b.surface->rank;
    if (a.surface->body != b.surface->body) return a.surface->body < b.surface->body;
    return index_of(a) < index_of(b);
  }
  /// Returns the index of the body in the list, count_ if it is not there.
  int index_of(const Body& body) const {
    int i = 0;
    while (i < count_ && !(inside_[i] == body)) ++i;
    return i;
  }

  int count_ = 0;
  Body inside_[kMaxBodies];
};

}  // namespace aureole
