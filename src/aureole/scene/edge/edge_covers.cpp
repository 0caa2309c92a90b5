// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/edge/edge_covers.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "aureole/core/parallel.h"

namespace aureole {
namespace {

/// Relative uncertainty of vertices, over the largest coordinate.
constexpr double kRounding = 1e-6;

double largest(const Vec3& p) { return double(max_component(abs(p))); }

/// Returns whether a point v of the triangle, relative to a point of the edge, has n0.v > 0 and n1.v < 0, or
/// both with the opposite signs: only such faces can lie before or behind an edge that is an outline. A
/// border has faces on one side only, so that all faces can, except those in its plane.
bool may_cover(const std::array<Vec3, 3>& triangle, const MeshEdge& edge) {
  double scale = std::max(largest(edge.a), largest(edge.b)), s0[3], s1[3];
  for (int i = 0; i < 3; ++i) {
    const Double3 v = Double3(triangle[std::size_t(i)]) - Double3(edge.a);
    s0[i] = dot(v, Double3(edge.n0)), s1[i] = dot(v, Double3(edge.n1));
    scale = std::max(scale, largest(triangle[std::size_t(i)]));
  }
  // Normals have the precision of floats, which matters for faces far along the edge.
  const double off = 4 * kRounding * scale;
  // An early exit: most edges and faces belong to a convex body.
  if (!edge.is_boundary && std::max({s0[0], s0[1], s0[2], s1[0], s1[1], s1[2]}) <= off) return false;
  // Faces with a side along the edge, such as the edge's own faces, do not cover it.
  const Double3 e = normalize(Double3(edge.b) - Double3(edge.a));
  if (std::count_if(triangle.begin(), triangle.end(), [&](const Vec3& p) {
        return length(cross(Double3(p) - Double3(edge.a), e)) <= off;
      }) >= 2)
    return false;
  if (edge.is_boundary) return std::max({std::abs(s0[0]), std::abs(s0[1]), std::abs(s0[2])}) > off;
  // Returns whether a part of the triangle lies in both half-spaces, with `sign` for one of the two cases.
  const auto is_left = [&](double sign) {
    struct Corner {
      double a, b;
    };
    Corner corners[3], kept[4];
    for (int i = 0; i < 3; ++i) corners[i] = {sign * s0[i] - off, -sign * s1[i] - off};
    int count = 0;
    for (int i = 0; i < 3; ++i) {
      const Corner &p = corners[i], &q = corners[(i + 1) % 3];
      if (p.a > 0) kept[count++] = p;
      if ((p.a > 0) != (q.a > 0)) kept[count++] = {0, p.b + (q.b - p.b) * (p.a / (p.a - q.a))};
    }
    return std::any_of(kept, kept + count, [](const Corner& c) { return c.b > 0; });
  };
  return is_left(1) || is_left(-1);
}

/// An edge seen along a direction z of light. The x axis runs along the projected edge, from its vertex a.
struct View {
  View(const MeshEdge& edge, const Double3& d) : origin(edge.a), z(d) {
    const Double3 way = Double3(edge.b) - origin;
    const double rise = dot(way, z);
    const Double3 across = way - z * rise;
    shown = length(across);
    if (!(shown > 0)) return;
    x = across * (1 / shown), y = cross(z, x);
    slope = rise / shown;
  }

  Double3 origin, x, y, z;
  double shown, slope = 0;
};

/// Returns the part of the edge that a face covers; it is empty if `to` is not larger than `from`.
EdgeStretch covered_by(const std::array<Vec3, 3>& face, const View& view, double depth, double rounding) {
  Double3 p[3];
  double v[3];
  for (int i = 0; i < 3; ++i) p[i] = Double3(face[std::size_t(i)]) - view.origin, v[i] = dot(p[i], view.y);
  const bool above = v[0] > 0;
  if ((v[1] > 0) == above && (v[2] > 0) == above) return {0, 0};
  // The positions at which two sides of the face cross the edge's line, and their depths behind the line.
  double at[2], behind[2];
  int count = 0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    if ((v[i] > 0) == (v[j] > 0)) continue;
    const Double3 q = p[i] + (p[j] - p[i]) * (v[i] / (v[i] - v[j]));
    at[count] = dot(q, view.x);
    behind[count] = dot(q, view.z) - view.slope * at[count];
    ++count;
  }
  if (at[1] < at[0]) std::swap(at[0], at[1]), std::swap(behind[0], behind[1]);
  // Faces that touch leave no gap between them.
  double from = std::max(at[0] - rounding, 0.0), to = std::min(at[1] + rounding, view.shown);
  const double rate = (behind[1] - behind[0]) / std::max(at[1] - at[0], 1e-300);
  for (const double limit : {depth, -depth}) {
    // Clips to the part in which the face is within the depth limit.
    const bool first_in = limit > 0 ? behind[0] <= limit : behind[0] >= limit,
               second_in = limit > 0 ? behind[1] <= limit : behind[1] >= limit;
    if (!first_in && !second_in) return {0, 0};
    const double change = at[0] + (limit - behind[0]) / rate;
    if (!first_in) from = std::max(from, change);
    if (!second_in) to = std::min(to, change);
  }
  return {from / view.shown, to / view.shown};
}

}  // namespace

EdgeCovers::EdgeCovers(const EdgeIndex& index, const EdgeClusters& clusters, FaceTree faces, float depth) {
  const std::vector<MeshEdge>& edges = index.edges();
  if (edges.empty()) return;
  faces_ = std::move(faces.faces), tree_ = std::move(faces.tree);
  const std::vector<std::uint32_t>& sets_of = faces.set_of;
  constexpr std::size_t kTogether = 4096;
  const std::size_t part_count = (edges.size() + kTogether - 1) / kTogether;
  // If beams are as wide as the scene, each edge has all faces near it. The search visits a limited number of
  // faces for the edges of one part, which takes some seconds for all parts; the remaining edges get `kMany`.
  constexpr std::size_t kMostInAll = std::size_t(1) << 27;
  const std::size_t most_visited = std::max(kTogether * kMostListed, kMostInAll / part_count);
  const auto faces_about = [&](std::size_t number, std::vector<std::uint32_t>& found, std::size_t& visited) {
    const MeshEdge& edge = edges[number];
    const Vec3 way = edge.b - edge.a;
    const float size = length(way);
    const Beam beam{edge.a, way * (1 / size), depth, -depth, size + depth};
    const bool is_in_cluster = !clusters.of(number).empty();
    found.clear();
    if (!tree_.visit_while(beam, [&](std::uint32_t i) {
          if (++visited > most_visited) return false;
          if (!(is_in_cluster && sets_of[i] == edge.face0.set) && may_cover(faces_[i], edge) &&
              is_in_beam(faces_[i], beam))
            found.push_back(i);
          return found.size() <= kMostListed;
        }))
      found = {kMany};
  };
  struct Part {
    std::vector<std::uint32_t> listed, counts;
  };
  std::vector<Part> parts(part_count);
  for_ranges(
      parts.size(),
      [&](std::size_t first, std::size_t last) {
        std::vector<std::uint32_t> found;
        for (std::size_t i = first; i < last; ++i) {
          std::size_t visited = 0;
          for (std::size_t j = i * kTogether; j < std::min((i + 1) * kTogether, edges.size()); ++j) {
            faces_about(j, found, visited);
            parts[i].listed.insert(parts[i].listed.end(), found.begin(), found.end());
            parts[i].counts.push_back(std::uint32_t(found.size()));
          }
        }
      },
      1);
  begins_.reserve(edges.size() + 1);
  begins_.push_back(0);
  for (const Part& part : parts) {
    listed_.insert(listed_.end(), part.listed.begin(), part.listed.end());
    for (const std::uint32_t count : part.counts) begins_.push_back(begins_.back() + count);
  }
  if (listed_.empty()) {
    *this = {};
  } else if (std::ranges::find(listed_, kMany) == listed_.end()) {
    tree_ = {};
    // Only faces that are listed are kept.
    std::unordered_map<std::uint32_t, std::uint32_t> number;
    std::vector<Triangle> kept;
    for (std::uint32_t& i : listed_) {
      const auto [at, is_new] = number.try_emplace(i, std::uint32_t(kept.size()));
      if (is_new) kept.push_back(faces_[i]);
      i = at->second;
    }
    faces_ = std::move(kept);
  }
}

std::span<const EdgeStretch> EdgeCovers::open(const MeshEdge& edge, std::size_t number, const Vec3& d,
                                              float depth) const {
  thread_local std::vector<EdgeStretch> covered, open;
  covered.clear(), open.clear();
  const View view(edge, normalize(Double3(d)));
  if (!(view.shown > 0)) return open;
  const double rounding = kRounding * std::max(largest(edge.a), largest(edge.b));
  const auto cover = [&](std::uint32_t face) {
    const EdgeStretch part = covered_by(faces_[face], view, double(depth), rounding);
    if (part.from < part.to) covered.push_back(part);
  };
  const std::uint32_t first = begins_[number], last = begins_[number + 1];
  if (last - first == 1 && listed_[first] == kMany) {
    // The faces about the edge, searched along the light.
    const Vec3 middle = 0.5f * (edge.a + edge.b), half = 0.5f * (edge.b - edge.a);
    const float rise = std::abs(dot(half, d)), reach = depth + rise;
    const float radius = std::sqrt(std::max(0.f, length_squared(half) - rise * rise)) + float(rounding);
    tree_.visit({middle, d, radius, -reach, reach}, [&](std::uint32_t face) {
      if (may_cover(faces_[face], edge)) cover(face);
    });
  } else {
    for (std::uint32_t i = first; i < last; ++i) cover(listed_[i]);
  }
  std::sort(covered.begin(), covered.end(),
            [](const EdgeStretch& p, const EdgeStretch& q) { return p.from < q.from; });
  double from = 0;
  const double least = rounding / view.shown;
  const auto keep = [&](double to) {
    if (to - from > least) open.push_back({from, to});
  };
  for (const EdgeStretch& part : covered) {
    keep(part.from);
    from = std::max(from, part.to);
  }
  keep(1);
  return open;
}

}  // namespace aureole
