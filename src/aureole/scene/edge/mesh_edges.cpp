// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/edge/mesh_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

namespace aureole {
namespace {

using Double3 = std::array<double, 3>;

Double3 difference(const Vec3& a, const Vec3& b) {
  return {double(a.x) - b.x, double(a.y) - b.y, double(a.z) - b.z};
}
Double3 cross(const Double3& a, const Double3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double dot(const Double3& a, const Double3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
double length(const Double3& a) { return std::sqrt(dot(a, a)); }
Vec3 direction(const Double3& a, double scale) {
  return {float(a[0] * scale), float(a[1] * scale), float(a[2] * scale)};
}

/// For every vertex of every set the number of its position, equal for equal positions.
std::vector<std::vector<std::uint32_t>> weld(std::span<const TriangleSet> sets) {
  struct Vertex {
    Vec3 p;
    std::uint32_t set, index;
  };
  std::vector<Vertex> all;
  std::vector<std::vector<std::uint32_t>> number(sets.size());
  for (std::uint32_t s = 0; s < sets.size(); ++s) {
    number[s].resize(sets[s].positions.size());
    for (std::uint32_t i = 0; i < sets[s].positions.size(); ++i) all.push_back({sets[s].positions[i], s, i});
  }
  const auto key = [](const Vec3& p) { return std::tuple(p.x, p.y, p.z); };  // compares -0 and 0 equal
  std::sort(all.begin(), all.end(), [&](const Vertex& a, const Vertex& b) { return key(a.p) < key(b.p); });
  std::uint32_t next = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i > 0 && key(all[i].p) != key(all[i - 1].p)) ++next;
    number[all[i].set][all[i].index] = next;
  }
  return number;
}

/// A side of a triangle.
struct Side {
  std::uint64_t ends;  // numbers of the two positions, the smaller one first
  MeshFace face;
  std::uint8_t corner;  // where the side begins
  bool is_ascending;    // whether it runs from the smaller number
};

struct Face {
  std::array<Vec3, 3> p;
  Double3 normal;  // twice the area
};
Face face_of(std::span<const TriangleSet> sets, MeshFace f) {
  const TriangleSet& set = sets[f.set];
  Face face;
  for (int i = 0; i < 3; ++i)
    face.p[std::size_t(i)] = set.positions[set.triangles[f.triangle][std::size_t(i)]];
  face.normal = cross(difference(face.p[1], face.p[0]), difference(face.p[2], face.p[0]));
  return face;
}

}  // namespace

std::vector<MeshEdge> find_mesh_edges(std::span<const TriangleSet> sets) {
  const auto number = weld(sets);
  std::vector<Side> sides;
  for (std::uint32_t s = 0; s < sets.size(); ++s)
    for (std::uint32_t t = 0; t < sets[s].triangles.size(); ++t) {
      const TriangleIndices& indices = sets[s].triangles[t];
      if (!(length(face_of(sets, {s, t}).normal) > 0)) continue;
      for (std::uint8_t c = 0; c < 3; ++c) {
        const std::uint64_t a = number[s][indices[c]], b = number[s][indices[(c + 1) % 3]];
        if (a != b) sides.push_back({std::min(a, b) << 32 | std::max(a, b), {s, t}, c, a < b});
      }
    }
  std::sort(sides.begin(), sides.end(), [](const Side& x, const Side& y) {
    return std::tuple(x.ends, x.face.set, x.face.triangle) < std::tuple(y.ends, y.face.set, y.face.triangle);
  });

  std::vector<MeshEdge> edges;
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i + 1;
    while (end < sides.size() && sides[end].ends == sides[i].ends) ++end;
    const Side& side = sides[i];
    const Face face = face_of(sets, side.face);
    const double size = length(face.normal);
    MeshEdge edge{.a = face.p[side.corner],
                  .b = face.p[(side.corner + 1) % 3],
                  .n0 = direction(face.normal, 1 / size),
                  .n1 = {},
                  .face0 = side.face,
                  .face1 = side.face,
                  .is_boundary = end - i != 2,
                  .is_concave = false};
    bool is_flat = false;
    if (!edge.is_boundary) {
      const Side& other = sides[i + 1];
      const Face second = face_of(sets, other.face);
      // Neighbours that run the same way along their edge have normals on opposite sides of the surface.
      const double sign = side.is_ascending == other.is_ascending ? -1 : 1,
                   second_size = length(second.normal);
      const double sine = length(cross(face.normal, second.normal)) / (size * second_size);
      is_flat = sine < 1e-4 && sign * dot(face.normal, second.normal) > 0;
      edge.n1 = direction(second.normal, sign / second_size);
      edge.face1 = other.face;
      edge.is_concave = dot(face.normal, difference(second.p[(other.corner + 2) % 3], edge.a)) > 0;
    }
    if (!is_flat) edges.push_back(edge);
    i = end;
  }
  return edges;
}

}  // namespace aureole
