// SPDX-License-Identifier: Apache-2.0
// `EdgeIndex`: the edges and faces of triangle meshes near a ray, for the diffraction model `beams`
// (docs/diffraction_beams.md).
#pragma once

#include "aureole/scene/edge/beam_tree.h"
#include "aureole/scene/edge/mesh_edges.h"
#include "aureole/shape/surface_point.h"

namespace aureole {

/// Whether a part of a segment or of a triangle lies in a beam.
bool is_in_beam(const Vec3& a, const Vec3& b, const Beam& beam);
bool is_in_beam(const std::array<Vec3, 3>& triangle, const Beam& beam);

class EdgeIndex {
public:
  struct Face {
    std::array<Vec3, 3> p;
    MeshFace face;
  };

  EdgeIndex() = default;
  /// The contents of an index, which copies its data from the sets; `edges` leaves the faces out.
  enum class Of { edges, edges_and_faces };
  explicit EdgeIndex(std::span<const TriangleSet> sets, Of what = Of::edges_and_faces);

  const std::vector<MeshEdge>& edges() const { return edges_; }
  std::uint32_t number(const MeshEdge& edge) const { return std::uint32_t(&edge - edges_.data()); }
  const std::vector<Face>& faces() const { return faces_; }
  std::size_t memory_bytes() const;

  /// Calls visit(edge) for the edges in the beam that are outlines for its direction. The order is that of
  /// the tree, equal for equal scenes. No allocation.
  template <class Visit>
  void visit_edges(const Beam& beam, const Visit& visit) const {
    edge_tree_.visit(beam, [&](std::uint32_t i) {
      const MeshEdge& edge = edges_[i];
      if (edge.is_outline(beam.d) && is_in_beam(edge.a, edge.b, beam)) visit(edge);
    });
  }
  /// Whether an edge is within `distance` of a point; the distance is enlarged by rounding errors.
  bool has_edge_within(const Vec3& p, float distance) const {
    Bounds3 place;
    place.extend(p);
    return !visit_within(place, distance, [&](std::uint32_t i) {
      const MeshEdge& edge = edges_[i];
      const Vec3 way = edge.b - edge.a, to = p - edge.a;
      const float most = distance + gamma_bound(16) * max_component(abs(to));  // includes rounding errors
      // An early exit: most points are far from the edge's line.
      if (length_squared(cross(to, way)) > most * most * length_squared(way)) return true;
      return edge.squared_distance(p) > most * most;
    });
  }
  /// Calls visit(number of an edge) for a superset of the edges within `distance` of a box, for as long as it
  /// returns true. Returns whether it always did.
  template <class Visit>
  bool visit_within(const Bounds3& box, float distance, const Visit& visit) const {
    return edge_tree_.visit_within(box, distance, visit);
  }
  /// Calls visit(face) for the faces in the beam, whichever side of them is irradiated.
  template <class Visit>
  void visit_faces(const Beam& beam, const Visit& visit) const {
    face_tree_.visit(beam, [&](std::uint32_t i) {
      if (is_in_beam(faces_[i].p, beam)) visit(faces_[i]);
    });
  }

private:
  std::vector<MeshEdge> edges_;
  std::vector<Face> faces_;
  BeamTree edge_tree_, face_tree_;
};

}  // namespace aureole
