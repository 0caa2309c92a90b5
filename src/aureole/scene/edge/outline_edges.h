// SPDX-License-Identifier: Apache-2.0
// `OutlineEdges`: the diffraction factor u/u0 of straight segments that pass edges of the scene's shapes
// (optics/diffraction/boundary_wave.h). The detours of paths by way of the edges are exact, so that it holds from near the
// edge to the far field.
#pragma once

#include <complex>
#include <memory>
#include <string>
#include <vector>

#include "aureole/scene/edge/beam_tree.h"
#include "aureole/scene/edge/mesh_edges.h"
#include "aureole/scene/scene_parts.h"
#include "aureole/shape/geometry/double3.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

/// A straight segment whose ends are vertices of a path, in either order.
struct EdgeSegment {
  Double3 from;
  Double3 d;      ///< unit length
  double length;  ///< may be infinite
};

/// The part of an edge by way of which detours of a segment are short, and how it lies about the segment.
struct EdgePassage {
  const MeshEdge* edge;
  double begin, end;  ///< distances from edge->a
  double middle;      ///< where the detour of the whole line is smallest
  Double3 beside;     ///< a point just off the edge, on its open side
  bool is_open;       ///< whether the segment passes on the open side of the edge
  bool is_at_border;  ///< it passes so near to the edge that only a visibility test decides
};

class OutlineEdges {
public:
  /// Of the shapes that diffract (diffracting_shapes.h).
  explicit OutlineEdges(const SceneParts& parts);

  bool empty() const { return edges_.empty(); }
  std::size_t edge_count() const { return edges_.size(); }
  const std::vector<std::string>& notes() const { return notes_; }

  /// |v| up to which contributions count fully; they fade out up to 4/3 of it. 15 in scenes of many edges.
  double window() const { return window_; }

  /// Calls visit(passage) for the edges that are outlines of their surfaces for light along the segment and by way of which
  /// a detour lies within the window of the longest wavelength (in units of the scene).
  template <class Visit>
  void visit(const EdgeSegment& segment, double wavelength, const Visit& visit) const {
    const double detour = largest_detour(wavelength);
    tree_.visit(beam_of(segment, detour), [&](std::uint32_t i) {
      EdgePassage passage;
      if (find_passage(edges_[i], segment, detour, passage)) visit(passage);
    });
  }

  /// Subtracts the boundary wave of an edge from u/u0 at each of `count` wavelengths [unit of length of the scene].
  void subtract(const EdgePassage& passage, const EdgeSegment& segment, bool is_open,
                const double* wavelengths, int count, std::complex<double>* field) const;

  /// Wavelengths of a path in units of the scene.
  double wavelength(float nm) const { return double(nm) * nm_; }

private:
  double largest_detour(double wavelength) const {
    const double largest_v = window_ * 4 / 3;
    return wavelength * largest_v * largest_v / 4;
  }
  Beam beam_of(const EdgeSegment& segment, double detour) const;
  bool find_passage(const MeshEdge& edge, const EdgeSegment& segment, double detour, EdgePassage& out) const;

  std::vector<MeshEdge> edges_;
  std::vector<float> lift_;  ///< of each set of triangles, see DiffractingShapes
  BeamTree tree_;
  Bounds3 box_;
  double nm_;
  double window_ = 60;
  std::vector<std::string> notes_;
};

/// Whether both have the same shapes with the same BSDFs, and so the same edges.
bool has_same_outlines(const SceneParts& a, const SceneParts& b);

}  // namespace aureole
