// SPDX-License-Identifier: Apache-2.0
#include "aureole/shape/mesh/mesh_patches.h"

#include <algorithm>
#include <bit>
#include <numeric>

#include "aureole/shape/geometry/double3.h"
#include "aureole/shape/surface_point.h"

namespace aureole {

namespace {

/// One triangle's half of an edge shared by two triangles: its vertices (equal positions count as one), the
/// triangle and the opposite corner.
struct HalfEdge {
  std::uint32_t from, to, triangle;
  std::uint8_t apex;
  std::uint64_t key() const { return std::uint64_t(std::min(from, to)) << 32 | std::max(from, to); }
};

/// Returns for every vertex the first one at the same position, since readers split vertices where attributes
/// differ.
std::vector<std::uint32_t> first_at_position(std::span<const Vec3> positions) {
  std::vector<std::uint32_t> order(positions.size()), first(positions.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto less = [&](std::uint32_t a, std::uint32_t b) {
    for (int k = 0; k < 3; ++k)
      if (positions[a][k] != positions[b][k]) return positions[a][k] < positions[b][k];
    return a < b;
  };
  std::sort(order.begin(), order.end(), less);
  for (std::size_t i = 0; i < order.size(); ++i)
    first[order[i]] =
        i > 0 && positions[order[i]] == positions[order[i - 1]] ? first[order[i - 1]] : order[i];
  return first;
}

enum class Figure { none, parallelogram, rectangle };

/// Classifies the figure formed by two triangles with corners a, p, q and b, q, p.
Figure figure(const Vec3& a, const Vec3& p, const Vec3& q, const Vec3& b) {
  const Double3 ex = Double3(p) - Double3(a), ey = Double3(q) - Double3(a);
  const Double3 gap = Double3(b) - (Double3(a) + ex + ey);
  const double shorter = std::min(length(ex), length(ey));
  const double rounding = 3e-7 * max_component(max(max(abs(a), abs(b)), max(abs(p), abs(q))));
  if (!(length(gap) <= std::min(rounding, 1e-4 * shorter))) return Figure::none;
  const double skew = std::abs(dot(ex, ey)) / (length(ex) * length(ey));
  return skew <= std::clamp(rounding / shorter, 1e-6, 1e-4) ? Figure::rectangle : Figure::parallelogram;
}

}  // namespace

void MeshPatch::measure(std::span<const Vec3> positions, std::span<const TriangleIndices> triangles) {
  double sum = 0;
  for (const std::uint32_t t : triangle) {
    if (t == kNone) continue;
    const Double3 a(positions[triangles[t][0]]), b(positions[triangles[t][1]]), c(positions[triangles[t][2]]);
    sum += 0.5 * length(cross(b - a, c - a));
  }
  area = float(sum);
  const TriangleIndices& t = triangles[triangle[0]];
  const Vec3 &a = positions[t[apex[0]]], &b = positions[t[(apex[0] + 1) % 3]],
             &c = positions[t[(apex[0] + 2) % 3]];
  longest_squared = max_component({length_squared(b - a), length_squared(c - a), length_squared(c - b)});
  center = (a + b + c) * (1.f / 3);
  origin = a, along_x = b - a, along_y = c - a;
  const Double3 n = cross(Double3(b) - Double3(a), Double3(c) - Double3(a));
  ng = (n * (1 / length(n))).to_float();
  // Error bound: the rounding of edges and sum, plus the deviation from a parallelogram.
  error = gamma_bound(8) * dot(abs(ng), abs(a) + abs(b) + abs(c));
  if (is_pair()) {
    const Double3 last(positions[triangles[triangle[1]][apex[1]]]);
    const Double3 gap = last - (Double3(b) - Double3(a) + Double3(c));
    error += float(1.001 * std::abs(dot(gap, Double3(ng))));
  }
}

MeshPatches MeshPatches::build(std::span<const Vec3> positions, std::span<const TriangleIndices> triangles) {
  const std::vector<std::uint32_t> first = first_at_position(positions);
  std::vector<HalfEdge> edges;
  edges.reserve(3 * triangles.size());
  for (std::uint32_t i = 0; i < triangles.size(); ++i)
    for (std::uint8_t k = 0; k < 3; ++k)
      edges.push_back({first[triangles[i][(k + 1) % 3]], first[triangles[i][(k + 2) % 3]], i, k});
  std::sort(edges.begin(), edges.end(), [](const HalfEdge& a, const HalfEdge& b) {
    return std::make_pair(a.key(), a.triangle) < std::make_pair(b.key(), b.triangle);
  });

  MeshPatches result;
  std::vector<MeshPatch> partner(triangles.size());
  std::vector<bool> paired(triangles.size(), false);
  // Rectangles are paired first, since they are sampled better than parallelograms.
  for (const Figure wanted : {Figure::rectangle, Figure::parallelogram})
    for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
      const HalfEdge &e = edges[i], &f = edges[i + 1];
      if (e.key() != f.key() || e.from != f.to || paired[e.triangle] || paired[f.triangle]) continue;
      const Vec3 &a = positions[triangles[e.triangle][e.apex]], &b = positions[triangles[f.triangle][f.apex]];
      if (figure(a, positions[e.from], positions[e.to], b) != wanted) continue;
      paired[e.triangle] = paired[f.triangle] = true;
      const bool in_order = e.triangle < f.triangle;
      const HalfEdge &lower = in_order ? e : f, &upper = in_order ? f : e;
      MeshPatch& patch = partner[lower.triangle];
      patch.triangle[0] = lower.triangle, patch.triangle[1] = upper.triangle;
      patch.apex[0] = lower.apex, patch.apex[1] = upper.apex;
      patch.is_rectangle = wanted == Figure::rectangle;
    }

  result.of_triangle.assign(triangles.size(), MeshPatch::kNone);
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    if (result.of_triangle[i] != MeshPatch::kNone) continue;
    MeshPatch patch = partner[i];
    if (!paired[i]) patch.triangle[0] = i;
    patch.measure(positions, triangles);
    for (const std::uint32_t t : patch.triangle)
      if (t != MeshPatch::kNone) result.of_triangle[t] = std::uint32_t(result.patches.size());
    result.patches.push_back(patch);
  }
  return result;
}

}  // namespace aureole
