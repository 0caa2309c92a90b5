// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/edge/edge_index.h"

#include <algorithm>
#include <cmath>

namespace aureole {
namespace {

/// A point relative to the ray: its distance along the ray, and its component perpendicular to it.
struct Relative {
  float t;
  Vec3 across;
};
Relative relative(const Vec3& p, const Beam& beam) {
  const Vec3 v = p - beam.o;
  const float t = dot(v, beam.d);
  return {t, v - beam.d * t};
}

/// Returns the perpendicular component of the line through two points at the distance t along the ray.
Vec3 at_distance(const Relative& a, const Relative& b, float t) {
  return a.across + (b.across - a.across) * ((t - a.t) / (b.t - a.t));
}

/// Returns the smallest squared distance from the ray to the segment between two perpendicular components.
float distance_squared(const Vec3& a, const Vec3& b) {
  const Vec3 e = b - a;
  const float size = length_squared(e);
  const float s = size > 0 ? std::clamp(-dot(a, e) / size, 0.f, 1.f) : 0.f;
  return length_squared(a + e * s);
}

}  // namespace

bool is_in_beam(const Vec3& a, const Vec3& b, const Beam& beam) {
  Relative first = relative(a, beam), second = relative(b, beam);
  if (first.t > second.t) std::swap(first, second);
  if (second.t < beam.begin || first.t > beam.end) return false;
  const Vec3 from = first.t < beam.begin ? at_distance(first, second, beam.begin) : first.across;
  const Vec3 to = second.t > beam.end ? at_distance(first, second, beam.end) : second.across;
  return distance_squared(from, to) <= beam.radius * beam.radius;
}

bool is_in_beam(const std::array<Vec3, 3>& triangle, const Beam& beam) {
  for (std::size_t i = 0; i < 3; ++i)
    if (is_in_beam(triangle[i], triangle[(i + 1) % 3], beam)) return true;
  // No side is near. The remaining case is a triangle around the beam. Either the ray hits it, or it lies
  // along the ray and an end of the beam cuts it: then its chord in the plane of that end is near.
  std::array<Relative, 3> p;
  for (std::size_t i = 0; i < 3; ++i) p[i] = relative(triangle[i], beam);
  for (const float t : {beam.begin, beam.end}) {
    Vec3 chord[2];
    int count = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const Relative &a = p[i], &b = p[(i + 1) % 3];
      if ((a.t < t) != (b.t < t) && count < 2) chord[count++] = at_distance(a, b, t);
    }
    if (count == 2 && distance_squared(chord[0], chord[1]) <= beam.radius * beam.radius) return true;
  }
  const Vec3 n = cross(triangle[1] - triangle[0], triangle[2] - triangle[0]);
  const float slope = dot(n, beam.d);
  if (slope == 0) return false;
  const float t = dot(n, triangle[0] - beam.o) / slope;
  if (t < beam.begin || t > beam.end) return false;
  float least = INFINITY, most = -INFINITY;
  for (std::size_t i = 0; i < 3; ++i) {
    const float side = dot(cross(p[i].across, p[(i + 1) % 3].across), beam.d);
    least = std::min(least, side), most = std::max(most, side);
  }
  return least >= 0 || most <= 0;
}

EdgeIndex::EdgeIndex(std::span<const TriangleSet> sets, Of what) : edges_(find_mesh_edges(sets)) {
  std::vector<Bounds3> boxes;
  std::vector<NormalCone> cones;
  for (const MeshEdge& edge : edges_) {
    Bounds3& box = boxes.emplace_back();
    box.extend(edge.a), box.extend(edge.b);
    cones.push_back(edge.is_boundary ? NormalCone{} : NormalCone::of(edge.n0, edge.n1));
  }
  edge_tree_ = BeamTree(boxes, cones);
  if (what == Of::edges) return;
  boxes.clear();
  for (std::uint32_t s = 0; s < sets.size(); ++s)
    for (std::uint32_t t = 0; t < sets[s].triangles.size(); ++t) {
      const TriangleIndices& indices = sets[s].triangles[t];
      faces_.push_back(
          {{sets[s].positions[indices[0]], sets[s].positions[indices[1]], sets[s].positions[indices[2]]},
           {s, t}});
      Bounds3& box = boxes.emplace_back();
      for (const Vec3& p : faces_.back().p) box.extend(p);
    }
  face_tree_ = BeamTree(boxes);
}

std::size_t EdgeIndex::memory_bytes() const {
  return edges_.size() * sizeof(MeshEdge) + faces_.size() * sizeof(Face) + edge_tree_.memory_bytes() +
         face_tree_.memory_bytes();
}

}  // namespace aureole
