// SPDX-License-Identifier: Apache-2.0
// `EdgeLines`: finds the edges whose straight lines pass near a beam of light, several at once. Most segments of
// paths have no edge near them, so that this test is most of what diffraction costs there.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "aureole/optics/lanes.h"
#include "aureole/scene/edge/beam_tree.h"
#include "aureole/scene/edge/mesh_edges.h"
#include "aureole/shape/geometry/double3.h"

namespace aureole {

class EdgeLines {
public:
  EdgeLines() = default;
  /// Orders the edges so that those near each other are adjacent in memory.
  explicit EdgeLines(std::vector<MeshEdge>& edges) : count_(edges.size()) {
    if (count_ > kFew) {
      const std::vector<MeshEdge> unordered = edges;
      const BeamTree tree(boxes_of(edges));
      for (std::size_t i = 0; i < count_; ++i) edges[i] = unordered[tree.items()[i]];
      tree_ = BeamTree(boxes_of(edges));
    }
    Bounds3 box;
    for (const MeshEdge& edge : edges) box.extend(edge.a), box.extend(edge.b);
    if (count_ > 0) center_ = Double3(box.center()), largest_ = 0.5f * length(box.diagonal());
    // The lanes behind the last edge repeat it.
    const std::size_t padded = count_ + (count_ > 0 ? kFloatLanes - 1 : 0);
    for (auto& values : lines_) values.resize(padded);
    for (auto& values : single_) values.resize(padded);
    for (std::size_t i = 0; i < padded; ++i) {
      const MeshEdge& edge = edges[std::min(i, count_ - 1)];
      const Double3 a(edge.a), along = Double3(edge.b) - a, e = along * (1 / length(along));
      const double values[] = {a.x, a.y, a.z, e.x, e.y, e.z};
      const Double3 near = a - center_;
      const double near_values[] = {near.x, near.y, near.z, e.x, e.y, e.z};
      for (std::size_t k = 0; k < lines_.size(); ++k)
        lines_[k][i] = values[k], single_[k][i] = float(near_values[k]);
    }
  }

  /// Calls visit(i) for a superset of the edges within a distance of the line through `o` with the unit direction
  /// `d`, by their numbers. `beam()` returns a beam about the line that contains all edges that matter. `visit` may
  /// make `squared_radius` smaller. O(log n) for n edges of which few are near.
  template <class MakeBeam, class Visit>
  void visit(const Double3& o, const Double3& d, const double& squared_radius, const MakeBeam& beam,
             const Visit& visit) const {
    constexpr double kRounding = 1.0001;
    if (count_ > kFew) {
      Beam narrowing = beam();
      double radius2 = squared_radius;
      tree_.visit(narrowing, [&](std::uint32_t i) {
        const auto value = [&](std::size_t k) { return lines_[k][i]; };
        if (excess(value, o, d, radius2 * kRounding) > 0) return;
        visit(i);
        if (squared_radius < radius2) radius2 = squared_radius, narrowing.radius = float(std::sqrt(radius2));
      });
      return;
    }
    for (std::size_t i = 0; i < count_; i += kLanes) {
      const auto value = [&](std::size_t k) { return optics::load_lanes(&lines_[k][i]); };
      const unsigned near = optics::lanes_of(excess(value, o, d, squared_radius * kRounding) <= 0);
      if (near == 0) continue;
      for (std::size_t k = 0; k < std::min(kLanes, count_ - i); ++k)
        if (near >> k & 1) visit(std::uint32_t(i + k));
    }
  }

  /// Whether `visit` would find an edge, as a faster test for few edges.
  bool has_near(const Double3& o, const Double3& d, double squared_radius) const {
    if (count_ > kFew) return true;
    // Single precision: errors of distances are bounded by `tolerance`, and (x + y)^2 <= 2 x^2 + 2 y^2.
    const Vec3 from = (o - center_).to_float(), along = d.to_float();
    const float tolerance = 1e-6f * (largest_ + length(from));
    const float radius2 = 2.0002f * float(squared_radius), tolerance2 = 2 * tolerance * tolerance;
    const auto coordinate = [&](std::size_t k, std::size_t i) {
      FloatLanes lanes;
      std::memcpy(&lanes, &single_[k][i], sizeof lanes);
      return lanes;
    };
    for (std::size_t i = 0; i < count_; i += kFloatLanes) {
      const FloatLanes ex = coordinate(3, i), ey = coordinate(4, i), ez = coordinate(5, i);
      const FloatLanes nx = ey * along.z - ez * along.y, ny = ez * along.x - ex * along.z,
                       nz = ex * along.y - ey * along.x;
      const FloatLanes apart = (coordinate(0, i) - from.x) * nx + (coordinate(1, i) - from.y) * ny +
                               (coordinate(2, i) - from.z) * nz;
      const FloatLanes over = apart * apart - radius2 * (nx * nx + ny * ny + nz * nz) - tolerance2;
      if (__builtin_ia32_movmskps256(over) != 0) return true;
    }
    return false;
  }

private:
  static constexpr std::size_t kFloatLanes = 8;
  using FloatLanes [[gnu::vector_size(kFloatLanes * sizeof(float))]] = float;
  static constexpr std::size_t kLanes = std::size_t(optics::kLanes);
  static constexpr std::size_t kFew = 96;  ///< testing all of so many edges takes less time than a tree

  static std::vector<Bounds3> boxes_of(std::span<const MeshEdge> edges) {
    std::vector<Bounds3> boxes;
    boxes.reserve(edges.size());
    for (const MeshEdge& edge : edges) boxes.emplace_back().extend(edge.a), boxes.back().extend(edge.b);
    return boxes;
  }

  /// Returns a number above 0 if the lines are farther from the beam's line than its radius. `value(k)`: the
  /// coordinates of their begins (k = 0, 1, 2) and directions (3, 4, 5).
  template <class Value>
  static auto excess(const Value& value, const Double3& o, const Double3& d, double radius2) {
    const auto ex = value(3), ey = value(4), ez = value(5);
    const auto nx = ey * d.z - ez * d.y, ny = ez * d.x - ex * d.z, nz = ex * d.y - ey * d.x;
    const auto apart = (value(0) - o.x) * nx + (value(1) - o.y) * ny + (value(2) - o.z) * nz;
    // Lines parallel to the beam have no common perpendicular of a known direction: they count as near.
    return apart * apart - radius2 * (nx * nx + ny * ny + nz * nz) - 1e-24;
  }

  std::array<std::vector<double>, 6> lines_;
  std::array<std::vector<float>, 6> single_;  ///< begins relative to `center_`
  Double3 center_{};
  float largest_ = 0;  ///< distance of an edge's end from `center_`
  std::size_t count_ = 0;
  BeamTree tree_;
};

}  // namespace aureole
