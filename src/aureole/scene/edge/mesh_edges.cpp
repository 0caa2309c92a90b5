// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/edge/mesh_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <tuple>

#include "aureole/scene/edge/beam_tree.h"
#include "aureole/shape/geometry/double3.h"

namespace aureole {
namespace {

Double3 difference(const Vec3& a, const Vec3& b) { return Double3(a) - Double3(b); }

/// Returns, for every vertex of every set, the number of its position; equal positions have equal numbers.
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
  const auto key = [](const Vec3& p) { return std::tuple(p.x, p.y, p.z); };  // -0 and 0 compare equal
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
  std::uint8_t corner;  // the corner at which the side begins
};

struct Face {
  std::array<Vec3, 3> p;
  Double3 normal;  // its length is twice the area
};
Face face_of(std::span<const TriangleSet> sets, MeshFace f) {
  const TriangleSet& set = sets[f.set];
  Face face;
  for (int i = 0; i < 3; ++i)
    face.p[std::size_t(i)] = set.positions[set.triangles[f.triangle][std::size_t(i)]];
  face.normal = cross(difference(face.p[1], face.p[0]), difference(face.p[2], face.p[0]));
  return face;
}

Bounds3 box_of(const Face& face) {
  Bounds3 box;
  for (const Vec3& p : face.p) box.extend(p);
  return box;
}

/// Returns the uncertainty of corners: eight units in the last place of floats as large as the largest
/// coordinate.
double rounding_of(const Bounds3& box) {
  constexpr double kRounding = 5e-7;
  return kRounding * std::max(max_component(abs(box.lower)), max_component(abs(box.upper)));
}

/// Whether a triangle has an extent in floats: a positive area, and a size above the uncertainty of its
/// corners.
bool has_extent(const Face& face) {
  const Bounds3 box = box_of(face);
  return length(face.normal) > 0 && double(max_component(box.diagonal())) > rounding_of(box);
}

/// The faces that share one line a -> b, by their angles about the line.
class Fan {
public:
  explicit Fan(const Vec3& a, const Vec3& b) : a_(a), e_(normalize(difference(b, a))) {
    make_basis(e_, x_, y_);
  }

  void add(const Face& face, MeshFace id, const Vec3& third) {
    const Double3 to = difference(third, a_);
    angles_.push_back({std::atan2(dot(to, y_), dot(to, x_)), id, face.normal});
  }

  /// Sets the edge, or returns false if there is none. Light that passes the edge must have all faces on one
  /// side, so that of many faces the two at the widest gap count. If no gap is wider than half a turn, there
  /// are faces on both sides from every direction.
  bool make_edge(MeshEdge& edge) {
    std::sort(angles_.begin(), angles_.end(), [](const Spoke& x, const Spoke& y) {
      return std::tuple(x.angle, x.face.set, x.face.triangle) <
             std::tuple(y.angle, y.face.set, y.face.triangle);
    });
    std::size_t after = 0;  // the spoke at which the widest gap ends
    double widest = -1;
    for (std::size_t i = 0; i < angles_.size(); ++i) {
      const double before = i > 0 ? angles_[i - 1].angle : angles_.back().angle - 2 * std::numbers::pi;
      if (angles_[i].angle - before > widest) widest = angles_[i].angle - before, after = i;
    }
    // Two faces that continue each other in one plane make no edge.
    if (widest < std::numbers::pi + kFlat) return false;
    const Spoke* first = &angles_[after];
    const Spoke* last = &angles_[(after + angles_.size() - 1) % angles_.size()];
    edge.is_boundary = 2 * std::numbers::pi - widest < kFlat;
    const auto is_earlier = [](const Spoke& x, const Spoke& y) {
      return std::tuple(x.face.set, x.face.triangle) < std::tuple(y.face.set, y.face.triangle);
    };
    if (edge.is_boundary)
      first = last = &*std::min_element(angles_.begin(), angles_.end(), is_earlier);
    else if (is_earlier(*last, *first))
      std::swap(first, last);
    const auto out = [&](const Spoke& s) { return x_ * std::cos(s.angle) + y_ * std::sin(s.angle); };
    const Double3 own = out(*first), other = out(*last);
    // The edge is directed so that the first face lies to the left, seen from the side of its own normal.
    const double sign = dot(cross(e_, own), first->normal) < 0 ? -1 : 1;
    if (sign < 0) std::swap(edge.a, edge.b);
    edge.n0 = normalize(cross(e_, own) * sign).to_float();
    edge.face0 = edge.face1 = first->face;
    edge.n1 = {}, edge.is_concave = false;
    if (edge.is_boundary) return true;
    edge.n1 = normalize(cross(other, e_) * sign).to_float();
    edge.face1 = last->face;
    edge.is_concave = dot(cross(e_, own) * sign, other) > 0;
    return true;
  }

private:
  static constexpr double kFlat = 1e-4;  ///< radians
  struct Spoke {
    double angle;
    MeshFace face;
    Double3 normal;  ///< by the face's winding
  };
  Vec3 a_;
  Double3 e_, x_, y_;
  std::vector<Spoke> angles_;
};

/// Removes from the borders of surfaces the parts that lie inside another face in the same plane, or along a
/// side of an earlier one: sheets that overlap in one plane, or touch without common vertices, are one sheet.
class FlatUnion {
public:
  explicit FlatUnion(std::span<const TriangleSet> sets) : sets_(sets) {
    std::vector<Bounds3> boxes;
    for (std::uint32_t s = 0; s < sets.size(); ++s)
      for (std::uint32_t t = 0; t < sets[s].triangles.size(); ++t) {
        const Face face = face_of(sets, {s, t});
        if (!has_extent(face)) continue;
        faces_.push_back({s, t});
        roundings_.push_back(rounding_of(box_of(face)));
        // The margin lets edges with smaller uncertainty find the face.
        Bounds3& box = boxes.emplace_back(box_of(face));
        const auto margin = float(2 * roundings_.back()) * Vec3{1, 1, 1};
        box.lower = box.lower - margin, box.upper = box.upper + margin;
      }
    tree_ = BeamTree(boxes);
  }

  /// Appends the parts of a boundary edge that no other face covers.
  void append_rest(const MeshEdge& edge, std::vector<MeshEdge>& edges) {
    const Double3 a(edge.a), along = difference(edge.b, edge.a);
    const double size = length(along);
    const Face face = face_of(sets_, edge.face0);
    const Double3& normal = face.normal;
    const Double3 e = along * (1 / size),
                  n = normal * ((dot(normal, Double3(edge.n0)) < 0 ? -1 : 1) / length(normal)),
                  out = cross(e, n);
    const double own = rounding_of(box_of(face));
    covered_.clear();
    tree_.visit({edge.a, e.to_float(), float(2 * own), 0.f, float(size)}, [&](std::uint32_t i) {
      // The larger of both uncertainties, so that both faces agree on which points coincide.
      const double rounding = std::max(own, roundings_[i]);
      const MeshFace id = faces_[i];
      if (id.set == edge.face0.set && id.triangle == edge.face0.triangle) return;
      double u[3], v[3];
      for (int c = 0; c < 3; ++c) {
        const TriangleSet& set = sets_[id.set];
        const Double3 p = Double3(set.positions[set.triangles[id.triangle][std::size_t(c)]]) - a;
        if (std::abs(dot(p, n)) > rounding) return;  // the face lies in another plane
        u[c] = dot(p, e), v[c] = dot(p, out);
        if (std::abs(v[c]) <= rounding) v[c] = 0;
      }
      const bool is_earlier =
          std::tuple(id.set, id.triangle) < std::tuple(edge.face0.set, edge.face0.triangle);
      const bool is_beside = std::max({v[0], v[1], v[2]}) <= 0;  // on the side of the edge's own face
      double begin = INFINITY, end = -INFINITY;
      for (int c = 0; c < 3; ++c) {
        const int d = (c + 1) % 3;
        const auto meet = [&](double at) { begin = std::min(begin, at), end = std::max(end, at); };
        if (is_beside && v[c] == 0 && v[d] == 0) {
          if (is_earlier) meet(u[c]), meet(u[d]);
        } else if (!is_beside && (v[c] <= 0) != (v[d] <= 0)) {
          meet(u[c] + (u[d] - u[c]) * (v[c] / (v[c] - v[d])));  // just beyond the edge
        }
      }
      begin = std::max(begin, 0.0), end = std::min(end, size);
      if (end - begin > rounding) covered_.push_back({begin, end});
    });
    if (covered_.empty()) {
      edges.push_back(edge);
      return;
    }
    std::sort(covered_.begin(), covered_.end());
    double from = 0;
    const auto keep = [&](double to) {
      if (to - from <= 4 * own) return;
      MeshEdge part = edge;
      if (from > 0) part.a = (a + e * from).to_float();
      if (to < size) part.b = (a + e * to).to_float();
      edges.push_back(part);
    };
    for (const auto& [begin, end] : covered_) {
      keep(begin);
      from = std::max(from, end);
    }
    keep(size);
  }

private:
  std::span<const TriangleSet> sets_;
  std::vector<MeshFace> faces_;
  std::vector<double> roundings_;  ///< uncertainty of the corners of each face
  BeamTree tree_;
  std::vector<std::pair<double, double>> covered_;
};

}  // namespace

std::vector<MeshEdge> find_mesh_edges(std::span<const TriangleSet> sets) {
  const auto number = weld(sets);
  std::vector<Side> sides;
  for (std::uint32_t s = 0; s < sets.size(); ++s)
    for (std::uint32_t t = 0; t < sets[s].triangles.size(); ++t) {
      const TriangleIndices& indices = sets[s].triangles[t];
      const Face face = face_of(sets, {s, t});
      if (!has_extent(face)) continue;
      const double rounding = rounding_of(box_of(face));
      for (std::uint8_t c = 0; c < 3; ++c) {
        const std::uint64_t a = number[s][indices[c]], b = number[s][indices[(c + 1) % 3]];
        // A shorter side may belong to a face without extent: the neighbours of that face continue each other
        // there without an edge.
        const Vec3 side = abs(face.p[(c + 1u) % 3] - face.p[c]);
        if (a != b && double(max_component(side)) > 2 * rounding)
          sides.push_back({std::min(a, b) << 32 | std::max(a, b), {s, t}, c});
      }
    }
  std::sort(sides.begin(), sides.end(), [](const Side& x, const Side& y) {
    return std::tuple(x.ends, x.face.set, x.face.triangle) < std::tuple(y.ends, y.face.set, y.face.triangle);
  });

  std::vector<MeshEdge> edges;
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i + 1;
    while (end < sides.size() && sides[end].ends == sides[i].ends) ++end;
    const Face face = face_of(sets, sides[i].face);
    MeshEdge edge{.a = face.p[sides[i].corner],
                  .b = face.p[(sides[i].corner + 1) % 3],
                  .n0 = {},
                  .n1 = {},
                  .face0 = {},
                  .face1 = {},
                  .is_boundary = false,
                  .is_concave = false};
    Fan fan(edge.a, edge.b);
    for (std::size_t k = i; k < end; ++k) {
      const Face at = face_of(sets, sides[k].face);
      fan.add(at, sides[k].face, at.p[(sides[k].corner + 2) % 3]);
    }
    if (fan.make_edge(edge)) edges.push_back(edge);
    i = end;
  }
  const auto is_boundary = [](const MeshEdge& edge) { return edge.is_boundary; };
  if (std::none_of(edges.begin(), edges.end(), is_boundary)) return edges;
  FlatUnion flat(sets);
  std::vector<MeshEdge> left;
  left.reserve(edges.size());
  for (const MeshEdge& edge : edges) {
    if (edge.is_boundary)
      flat.append_rest(edge, left);
    else
      left.push_back(edge);
  }
  return left;
}

}  // namespace aureole
