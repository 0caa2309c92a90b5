// SPDX-License-Identifier: Apache-2.0
// A tree of boxes that finds the items in a beam of light: within a distance of a part of a ray.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "aureole/math/vec.h"

namespace aureole {

/// The points within `radius` of the ray o + t d, begin <= t <= end; d has unit length.
struct Beam {
  Vec3 o, d;
  float radius, begin, end;
};

/// Cone that contains the normals of the items in a node (Johnson & Cohen 2001, "Spatialized normal cone
/// hierarchies", Symposium on Interactive 3D Graphics).
struct NormalCone {
  Vec3 axis{};
  float sine = 2;  ///< of the half angle; 2 if that may be 90 degrees or more

  /// Returns false if all normals lie on one side of the plane perpendicular to `d`.
  bool straddles(const Vec3& d) const { return !(std::abs(dot(axis, d)) > sine); }
  static NormalCone of(const Vec3& a, const Vec3& b);
  NormalCone merged(const NormalCone& other) const;
};

class BeamTree {
public:
  BeamTree() = default;
  /// `boxes` has one box per item; `cones` has one cone per item or is empty.
  BeamTree(std::span<const Bounds3> boxes, std::span<const NormalCone> cones = {});

  /// Returns the numbers of all items in the order of the leaves.
  std::span<const std::uint32_t> items() const { return items_; }

  std::size_t memory_bytes() const {
    return nodes_.size() * sizeof(Node) + items_.size() * sizeof(std::uint32_t);
  }

  /// Calls visit(item) for every item whose box may intersect the beam and whose node straddles the beam's
  /// direction. It visits a superset of the items in the beam. O(log n + k) for beams that are short compared
  /// with the scene. No allocation.
  template <class Visit>
  void visit(const Beam& beam, const Visit& visit) const {
    visit_while(beam, [&](std::uint32_t item) {
      visit(item);
      return true;
    });
  }
  /// Calls visit(item) as `visit` does, for as long as it returns true. Returns whether it always did.
  template <class Visit>
  bool visit_while(const Beam& beam, const Visit& visit) const {
    const Vec3 inverse{1 / beam.d.x, 1 / beam.d.y, 1 / beam.d.z};
    return descend(
        [&](const Node& node) { return node.cone.straddles(beam.d) && meets(node.box, beam, inverse); },
        visit);
  }

  /// Calls visit(item) for the items in leaves whose boxes lie within `distance` of the box `from`, for as
  /// long as it returns true. Returns whether it always did.
  template <class Visit>
  bool visit_within(const Bounds3& from, float distance, const Visit& visit) const {
    return descend([&](const Node& node) { return squared_distance(node.box, from) <= distance * distance; },
                   visit);
  }

private:
  static constexpr std::size_t kMostDepth = 96;
  struct Node {
    Bounds3 box;
    NormalCone cone;
    std::uint32_t first = 0, count = 0;  ///< items, or the first of two children if count is 0
  };

  /// Calls visit(item) for the items of all leaves below nodes for which enters(node) is true, for as long as
  /// it returns true. Returns whether it always did.
  template <class Enters, class Visit>
  bool descend(const Enters& enters, const Visit& visit) const {
    if (nodes_.empty()) return true;
    std::array<std::uint32_t, kMostDepth> stack;
    std::size_t size = 0;
    stack[size++] = 0;
    while (size > 0) {
      const Node& node = nodes_[stack[--size]];
      if (!enters(node)) continue;
      if (node.count > 0) {
        for (std::uint32_t i = 0; i < node.count; ++i)
          if (!visit(items_[node.first + i])) return false;
      } else {
        stack[size++] = node.first;
        stack[size++] = node.first + 1;
      }
    }
    return true;
  }

  /// A box and the number of its item. Items are sorted in place, so that those of a node are adjacent in
  /// memory.
  struct Item;

  /// `begin` is the number of items before those of the node.
  void build(std::uint32_t node, std::span<Item> items, std::uint32_t begin, std::size_t depth,
             std::span<const NormalCone> cones);
  /// Returns whether the beam's part of the ray intersects the box enlarged by the radius, with a margin for
  /// rounding.
  static bool meets(const Bounds3& box, const Beam& beam, const Vec3& inverse) {
    const float radius = 1.00001f * beam.radius;
    float begin = beam.begin, end = beam.end;
    for (int i = 0; i < 3; ++i) {
      const float t0 = (box.lower[i] - radius - beam.o[i]) * inverse[i],
                  t1 = (box.upper[i] + radius - beam.o[i]) * inverse[i];
      begin = std::max(begin, std::min(t0, t1)), end = std::min(end, std::max(t0, t1));
    }
    // The rounding error is proportional to both distances, which are nearly equal here. `begin` is infinite
    // if a beam along an axis passes beside the box.
    return begin <= end + 2e-5f * std::abs(end);
  }

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> items_;
};

}  // namespace aureole
