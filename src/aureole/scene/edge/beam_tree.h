// SPDX-License-Identifier: Apache-2.0
// A tree of boxes that finds what lies in a beam of light: within a distance of a stretch of a ray.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "aureole/math/vec.h"

namespace aureole {

/// The points within `radius` of the ray o + t d, d of unit length, begin <= t <= end.
struct Beam {
  Vec3 o, d;
  float radius, begin, end;
};

/// Directions within an angle of an axis: normals of what lies in a node (Johnson & Cohen 2001, "Spatialized normal cone
/// hierarchies", Symposium on Interactive 3D Graphics).
struct NormalCone {
  Vec3 axis{};
  float sine = 2;  ///< of the half angle; 2 where that is 90 degrees or more, or anything may be

  /// False where all directions lie on one side of the plane across `d`.
  bool straddles(const Vec3& d) const { return !(std::abs(dot(axis, d)) > sine); }
  static NormalCone of(const Vec3& a, const Vec3& b);
  NormalCone merged(const NormalCone& other) const;
};

class BeamTree {
public:
  BeamTree() = default;
  /// One box per item; `cones` has one per item or none at all.
  BeamTree(std::span<const Bounds3> boxes, std::span<const NormalCone> cones = {});

  std::size_t memory_bytes() const {
    return nodes_.size() * sizeof(Node) + items_.size() * sizeof(std::uint32_t);
  }

  /// Calls visit(item) for every item whose box may meet the beam and whose node straddles its direction: a superset of what
  /// does. O(log n + k) for beams that are short against the scene; allocates nothing.
  template <class Visit>
  void visit(const Beam& beam, const Visit& visit) const {
    visit_while(beam, [&](std::uint32_t item) {
      visit(item);
      return true;
    });
  }
  /// The same for as long as visit(item) returns true; whether it always did.
  template <class Visit>
  bool visit_while(const Beam& beam, const Visit& visit) const {
    const Vec3 inverse{1 / beam.d.x, 1 / beam.d.y, 1 / beam.d.z};
    return descend(
        [&](const Node& node) { return node.cone.straddles(beam.d) && meets(node.box, beam, inverse); },
        visit);
  }

  /// Calls visit(item) for the items in leaves whose boxes lie within that distance of a box, for as long as it returns true; whether it
  /// always did.
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
    std::uint32_t first = 0, count = 0;  ///< items, or count 0 and the first of two children
  };

  /// Calls visit(item) for the items of all leaves that enters(node) leads to, for as long as it returns true; whether it always did.
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

  /// A box and its number: they are sorted in place, so that a node's lie beside one another in memory.
  struct Item;

  /// `begin`: how many items lie before those of the node.
  void build(std::uint32_t node, std::span<Item> items, std::uint32_t begin, std::size_t depth,
             std::span<const NormalCone> cones);
  /// The stretch of the ray against the box grown by the radius, and a little for rounding.
  static bool meets(const Bounds3& box, const Beam& beam, const Vec3& inverse) {
    const float radius = 1.00001f * beam.radius;
    float begin = beam.begin, end = beam.end;
    for (int i = 0; i < 3; ++i) {
      const float t0 = (box.lower[i] - radius - beam.o[i]) * inverse[i],
                  t1 = (box.upper[i] + radius - beam.o[i]) * inverse[i];
      begin = std::max(begin, std::min(t0, t1)), end = std::min(end, std::max(t0, t1));
    }
    // Rounding is in proportion to the two, which are alike then; `begin` is infinite where a beam along an axis passes beside the box.
    return begin <= end + 2e-5f * std::abs(end);
  }

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> items_;
};

}  // namespace aureole
