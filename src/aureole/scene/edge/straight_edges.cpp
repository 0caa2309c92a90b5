// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/edge/straight_edges.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "aureole/shape/geometry/double3.h"

namespace aureole {
namespace {

constexpr std::uint32_t kNone = ~0u;

/// Relative uncertainty of a vertex, over its largest coordinate.
constexpr float kRounding = 5e-7f;

/// One end of an edge.
struct End {
  Vec3 p;
  std::uint32_t edge;
  bool is_b;
};

Vec3 end_of(const MeshEdge& edge, bool b) { return b ? edge.b : edge.a; }

/// Whether the second edge may continue the first one. `first_b` and `second_b` tell which end of each edge
/// lies at the vertex where they join.
bool go_on(const MeshEdge& first, bool first_b, const MeshEdge& second, bool second_b) {
  if (first.is_boundary != second.is_boundary || first.is_concave != second.is_concave) return false;
  const auto away = [](const MeshEdge& edge, bool b) {
    return normalize(Double3(end_of(edge, !b)) - Double3(end_of(edge, b)));
  };
  // Smaller bends are detected by the vertices of the whole line.
  if (dot(away(first, first_b), away(second, second_b)) > -0.9999) return false;
  const auto same = [](const Vec3& a, const Vec3& b) { return length_squared(a - b) < 1e-8f; };
  if (same(first.n0, second.n0) && same(first.n1, second.n1)) return true;
  // The faces of a fold are in the order of the mesh, and the normals may point to the other side if the
  // first face lies there.
  return !first.is_boundary && ((same(first.n0, second.n1) && same(first.n1, second.n0)) ||
                                (same(first.n0, -second.n1) && same(first.n1, -second.n0)));
}

/// A sequence of edges that join.
struct Chain {
  struct Link {
    std::uint32_t edge;
    bool begins_at_b;
  };
  std::vector<Link> edges;
  std::vector<Vec3> vertices;  ///< one vertex more than edges

  void append(const std::vector<MeshEdge>& all, std::uint32_t edge, bool enters_at_b) {
    if (vertices.empty()) vertices.push_back(end_of(all[edge], enters_at_b));
    edges.push_back({edge, enters_at_b});
    vertices.push_back(end_of(all[edge], !enters_at_b));
  }
  /// Returns the vertex between two others that is farthest from the line through them, or `first` if none is
  /// off the line.
  std::size_t bend(std::size_t first, std::size_t last) const {
    const Double3 o(vertices[first]), way = Double3(vertices[last]) - o;
    const double size = length(way);
    double most =
        double(kRounding * std::max(max_component(abs(vertices[first])), max_component(abs(vertices[last]))));
    if (!(size > most)) return last - first > 1 ? first + (last - first) / 2 : first;
    std::size_t at = first;
    for (std::size_t i = first + 1; i < last; ++i)
      if (const double off = length(cross(Double3(vertices[i]) - o, way)) / size; off > most)
        most = off, at = i;
    return at;
  }
};

}  // namespace

StraightEdges::StraightEdges(const EdgeIndex& index) {
  const std::vector<MeshEdge>& edges = index.edges();
  std::vector<End> ends;
  ends.reserve(2 * edges.size());
  for (std::uint32_t i = 0; i < edges.size(); ++i)
    ends.push_back({edges[i].a, i, false}), ends.push_back({edges[i].b, i, true});
  const auto key = [](const End& end) { return std::tuple(end.p.x, end.p.y, end.p.z); };
  std::sort(ends.begin(), ends.end(), [&](const End& x, const End& y) {
    return std::tuple(key(x), x.edge, x.is_b) < std::tuple(key(y), y.edge, y.is_b);
  });

  // For each end of each edge, the edge that continues there, and the end at which that edge begins.
  struct Next {
    std::uint32_t edge = kNone;
    bool is_b = false;
  };
  std::vector<Next> next(2 * edges.size());
  bool any = false;
  const auto join = [&](const End& one, const End& other) {
    Next &from = next[2 * one.edge + one.is_b], &to = next[2 * other.edge + other.is_b];
    if (from.edge != kNone || to.edge != kNone || one.edge == other.edge ||
        !go_on(edges[one.edge], one.is_b, edges[other.edge], other.is_b))
      return;
    from = {other.edge, other.is_b}, to = {one.edge, one.is_b};
    any = true;
  };
  for (std::size_t i = 0; i < ends.size();) {
    std::size_t last = i + 1;
    while (last < ends.size() && key(ends[last]) == key(ends[i])) ++last;
    constexpr std::size_t kMost = 16;  // many edges that share a vertex are no line
    for (std::size_t j = i; j < last && last - i <= kMost; ++j)
      for (std::size_t k = j + 1; k < last; ++k) join(ends[j], ends[k]);
    if (last - i == 1) {
      // Vertices of meshes that touch may differ by rounding.
      const float reach = 2 * kRounding * max_component(abs(ends[i].p));
      Bounds3 place;
      place.extend(ends[i].p);
      index.visit_within(place, reach, [&](std::uint32_t other) {
        for (const bool b : {false, true})
          if (length_squared(end_of(edges[other], b) - ends[i].p) <= reach * reach)
            join(ends[i], {end_of(edges[other], b), other, b});
        return true;
      });
    }
    i = last;
  }
  if (!any) return;

  places_.resize(edges.size());
  std::vector<bool> done(edges.size());
  std::uint32_t line = 0;
  std::vector<std::pair<std::size_t, std::size_t>> parts;
  for (std::uint32_t start = 0; start < edges.size(); ++start) {
    if (done[start]) continue;
    // Finds the begin of the chain, or goes once around a closed chain.
    std::uint32_t edge = start;
    bool enters_at_b = false;
    for (Next back; (back = next[2 * edge + enters_at_b]).edge != kNone && back.edge != start;)
      edge = back.edge, enters_at_b = !back.is_b;
    Chain chain;
    for (;;) {
      chain.append(edges, edge, enters_at_b);
      done[edge] = true;
      const Next on = next[2 * edge + !enters_at_b];
      if (on.edge == kNone || done[on.edge]) break;
      edge = on.edge, enters_at_b = on.is_b;
    }
    // The chain is divided at its bends (Douglas & Peucker 1973).
    parts = {{0, chain.edges.size()}};
    while (!parts.empty()) {
      const auto [first, last] = parts.back();
      parts.pop_back();
      if (const std::size_t at = chain.bend(first, last); at != first) {
        parts.push_back({first, at}), parts.push_back({at, last});
        continue;
      }
      const Double3 begin(chain.vertices[first]), end(chain.vertices[last]);
      for (std::size_t i = first; i < last; ++i) {
        const Double3 from(chain.vertices[i]), to(chain.vertices[i + 1]);
        const auto before = float(length(from - begin)), after = float(length(end - to));
        const auto [piece, begins_at_b] = chain.edges[i];
        places_[piece] = {line, begins_at_b ? after : before, begins_at_b ? before : after};
      }
      ++line;
    }
  }
}

}  // namespace aureole
