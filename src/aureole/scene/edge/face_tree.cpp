// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/edge/face_tree.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include "aureole/core/parallel.h"
#include "aureole/shape/geometry/double3.h"

namespace aureole {
namespace {

using Triangle = FaceTree::Triangle;

Bounds3 box_about(const Triangle& triangle) {
  Bounds3 box;
  for (const Vec3& p : triangle) box.extend(p);
  return box;
}

/// Returns the tolerance within which points coincide, for coordinates as large as those of the box.
double rounding_in(const Bounds3& box) {
  constexpr double kOfCoordinates = 5e-7;
  return kOfCoordinates * double(std::max(max_component(abs(box.lower)), max_component(abs(box.upper))));
}

/// The plane of a triangle, with a unit normal. Points within `rounding` of it count as in it.
struct FacePlane {
  FacePlane(const Triangle& t, double rounding) : origin(t[0]), rounding(rounding) {
    n = cross(Double3(t[1]) - origin, Double3(t[2]) - origin);
    const double size = length(n);
    exists = size > 0;
    if (exists) n = n * (1 / size);
  }
  double above(const Vec3& p) const { return dot(Double3(p) - origin, n); }

  Double3 origin, n;
  double rounding;
  bool exists;
};

/// The heights of the corners of a triangle above a plane.
struct Heights {
  Heights(const Triangle& t, const FacePlane& plane) {
    for (std::size_t i = 0; i < 3; ++i) above[i] = plane.above(t[i]);
    straddles = std::min({above[0], above[1], above[2]}) < -plane.rounding &&
                std::max({above[0], above[1], above[2]}) > plane.rounding;
  }
  double above[3];
  bool straddles;
};

/// Returns the interval, as positions along d, in which a triangle that straddles a plane cuts the plane.
std::pair<double, double> cut(const Triangle& t, const Heights& heights, const Double3& d) {
  double at[2];
  int count = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const double from = heights.above[i], to = heights.above[j];
    if ((from > 0) == (to > 0)) continue;
    const Double3 p(t[i]);
    at[count++] = dot(p + (Double3(t[j]) - p) * (from / (from - to)), d);
  }
  return std::minmax(at[0], at[1]);
}

/// Whether two triangles intersect along a line inside both (Moeller 1997, "A fast triangle-triangle
/// intersection test"); `theirs` straddles the plane of `own`.
bool cross_each_other(const Triangle& own, const FacePlane& plane, const Triangle& theirs,
                      const Heights& their_heights) {
  const FacePlane other(theirs, plane.rounding);
  if (!plane.exists || !other.exists) return false;
  const Heights heights(own, other);
  const Double3 line = cross(plane.n, other.n);
  const double sine = length(line);
  if (!heights.straddles || !(sine > 0)) return false;
  const Double3 d = line * (1 / sine);
  const auto [own_from, own_to] = cut(own, heights, d);
  const auto [their_from, their_to] = cut(theirs, their_heights, d);
  return std::min(own_to, their_to) - std::max(own_from, their_from) > plane.rounding / sine;
}

bool have_common_corner(const Triangle& a, const Triangle& b) {
  return std::ranges::any_of(a, [&](const Vec3& p) { return std::ranges::find(b, p) != b.end(); });
}

}  // namespace

FaceTree::FaceTree(std::span<const TriangleSet> sets) {
  std::vector<Bounds3> boxes;
  for (std::uint32_t set = 0; set < sets.size(); ++set)
    for (const TriangleIndices& corners : sets[set].triangles) {
      Triangle& triangle = faces.emplace_back();
      for (std::size_t c = 0; c < 3; ++c) triangle[c] = sets[set].positions[corners[c]];
      boxes.push_back(box_about(triangle));
      set_of.push_back(set);
    }
  tree = BeamTree(boxes);
}

std::size_t count_crossing_faces(const FaceTree& all) {
  constexpr int kMostTried = 256;  // for each face
  std::atomic<std::size_t> count = 0;
  for_ranges(
      all.faces.size(),
      [&](std::size_t begin, std::size_t end) {
        std::size_t crossing = 0;
        for (std::size_t i = begin; i < end; ++i) {
          const Triangle& face = all.faces[i];
          const Bounds3 box = box_about(face);
          const double rounding = rounding_in(box);
          FacePlane plane(face, rounding);
          int tried = 0;
          bool crosses = false;
          all.tree.visit_within(box, 0, [&](std::uint32_t other) {
            const Triangle& theirs = all.faces[other];
            const Bounds3 their_box = box_about(theirs);
            if (other == i || squared_distance(box, their_box) > 0) return true;
            if (++tried > kMostTried) return false;
            plane.rounding = std::max(rounding, rounding_in(their_box));
            const Heights heights(theirs, plane);  // most faces lie on one side
            crosses = heights.straddles && !have_common_corner(face, theirs) &&
                      cross_each_other(face, plane, theirs, heights);
            return !crosses;
          });
          crossing += crosses;
        }
        count += crossing;
      },
      1024);
  return count;
}

std::string remark_on_crossings(const FaceTree& faces) {
  const std::size_t count = count_crossing_faces(faces);
  if (count == 0) return {};
  return "edges: " + std::to_string(count) + " of " + std::to_string(faces.faces.size()) +
         " faces cut through others; where they do there is no edge, and no light is diffracted";
}

}  // namespace aureole
