// SPDX-License-Identifier: Apache-2.0
// `OutlineEdges`: the diffraction factor u/u0 of straight segments that pass edges of the scene's shapes
// (optics/diffraction/boundary_wave.h). The detours of paths by way of the edges are exact, so that it holds from near the
// edge to the far field.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <optional>
#include <span>
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
  double length;  ///< kInfinity where one end is at infinity

  bool is_infinite() const { return length >= double(kInfinity); }
};

/// The part of an edge by way of which detours of a segment are short.
struct EdgePassage {
  const MeshEdge* edge;
  double begin, end;  ///< distances from edge->a
  double middle;      ///< where the detour of the whole line is smallest
  Double3 p;          ///< the point of that part next to `middle`, from the segment's begin
  Double3 in, out;    ///< unit directions of light from the segment's begin to `p`, and from there to its end

  /// Whether the segment passes the edge itself, and not a point beyond its ends.
  bool passes_middle() const { return middle > begin && middle < end; }
};

/// The obliquity factor cos(theta/2) of light that turns from one unit direction into another.
inline double obliquity_of_turn(const Double3& in, const Double3& out) {
  return std::sqrt(std::max(0.0, (1 + dot(in, out)) / 2));
}

/// How an edge parts light that comes to it and leaves it into its open side and that of its faces.
struct EdgeSide {
  Double3 normal;     ///< unit vector across edge and light, towards the open side
  Double3 beside;     ///< a point just off the edge, on its open side
  double offset;      ///< its distance from the edge
  bool is_open;       ///< whether the segment passes on the open side
  bool is_at_border;  ///< it passes so near to the edge that only a visibility test decides

  /// The side on which the segment is taken to pass, given whether it is free.
  bool takes_open(bool is_free) const { return is_at_border ? is_free : is_open; }
};

/// How two edges one behind the other act on a segment together.
struct EdgePairField {
  EdgeSide side1, side2;  ///< for light that goes by way of both
  double v1, v2;          ///< Fresnel's parameters at a unit wavelength, negative in the shadow of each
  double cosine;          ///< of the angle between them about the segment
  double r1, between,
      r2;  ///< distances along the segment: to the first, from there to the second, and on to the end
  double obliquity1, obliquity2;  ///< cos(theta/2) of paths by way of edge 1 alone and of edge 2 alone
  double height1;  ///< height above edge 2 of the ray from edge 1 straight to the segment's end
  double height2;  ///< height above edge 1 of the ray from the segment's begin straight to edge 2

  /// Their correlation (`two_edges_field`). Nearer to each other than a twentieth of the wavelength they are one edge.
  double correlation(double wavelength) const {
    const double apart = std::max(0.0, between - wavelength / 20);
    const double ratio = r1 / (r1 + apart) * r2 / (r2 + apart);
    return cosine * std::sqrt(ratio);
  }
  /// Whether visibility tests by way of single edges agree with half planes.
  bool agrees(bool first_clears, bool second_clears) const {
    const double rounding = 4 * std::max(side1.offset, side2.offset);
    const auto agree = [&](double height, bool clears) {
      return std::abs(height) < rounding || (height > 0) == clears;
    };
    return agree(height1, first_clears) && agree(height2, second_clears);
  }
};

class OutlineEdges {
public:
  /// Finds the edges of the shapes that diffract (diffracting_shapes.h).
  explicit OutlineEdges(const SceneParts& parts);

  const std::vector<std::string>& notes() const { return notes_; }

  /// Calls visit(passage) for the edges by way of which a detour lies within the window of the longest wavelength (in units
  /// of the scene).
  template <class Visit>
  void visit(const EdgeSegment& segment, double wavelength, const Visit& visit) const {
    const double detour = detour_of(window_ * 4 / 3, wavelength);
    tree_.visit(beam_of(segment, detour), [&](std::uint32_t i) {
      EdgePassage passage;
      if (find_passage(edges_[i], segment, detour, passage)) visit(passage);
    });
  }

  /// Whether there is an edge with |v| of at most `v`, or within the window if that is less.
  bool passes_within(double v, const EdgeSegment& segment, double wavelength) const {
    const double detour = detour_of(std::min(v, window_ * 4 / 3), wavelength);
    EdgePassage passage;
    return !tree_.visit_while(beam_of(segment, detour), [&](std::uint32_t i) {
      return !find_passage(edges_[i], segment, detour, passage);
    });
  }

  /// Sets the sides of an edge for light that comes to it along `in` and leaves it along `out`; false where it is no outline
  /// of its surface then. `grazes`: it also counts if light runs along one of its faces and the other one falls off.
  bool find_side(const EdgePassage& passage, const EdgeSegment& segment, const Double3& in,
                 const Double3& out, bool grazes, EdgeSide& side) const;

  /// Returns |v| of an edge at a unit wavelength, where the detour of its whole line is smallest.
  double parameter(const EdgePassage& passage, const EdgeSegment& segment) const;

  /// Subtracts the boundary wave of an edge from u/u0 at each of `count` wavelengths [unit of length of the scene].
  void subtract(const EdgePassage& passage, const EdgeSegment& segment, bool is_open,
                const double* wavelengths, int count, std::complex<double>* field) const;

  /// Sets how two edges act together, `first` being the one that the segment passes first; false where they do not: on
  /// opposite sides of the segment, at right angles on one shape, in one plane, with a common end, or where the segment
  /// passes an end of one.
  bool find_pair(const EdgePassage& first, const EdgePassage& second, const EdgeSegment& segment,
                 EdgePairField& out) const;
  /// An edge of a row of edges that act together.
  struct RowEdge {
    bool is_open;  ///< whether the segment is taken to pass on its open side
    /// Whether its wave was subtracted from u/u0 as that of a segment on its open side (true) or in its shadow (false);
    /// empty: it was not subtracted.
    std::optional<bool> subtracted;
  };
  /// Replaces the waves of edges one behind the other by their common field: of two edges `two_edges_field`, of more the
  /// product of the fields of neighbours over those of inner edges alone. `pairs[i]` are the edges i and i + 1; `obliquity`
  /// is cos(theta/2) of the turn by way of all.
  void add_row(std::span<const EdgePairField> pairs, std::span<const RowEdge> row, double obliquity,
               const double* wavelengths, int count, std::complex<double>* field) const;

  /// Wavelengths of a path in units of the scene.
  double wavelength(float nm) const { return double(nm) * nm_; }

private:
  static double detour_of(double v, double wavelength) { return wavelength * v * v / 4; }
  Beam beam_of(const EdgeSegment& segment, double detour) const;
  bool find_passage(const MeshEdge& edge, const EdgeSegment& segment, double detour, EdgePassage& out) const;

  std::vector<MeshEdge> edges_;
  std::vector<float> lift_;  ///< of each set of triangles, see DiffractingShapes
  BeamTree tree_;
  Bounds3 box_;
  double nm_;
  double window_ = 60;  ///< |v| up to which contributions count fully; they fade out up to 4/3 of it
  float welded_ = 0;    ///< vertices nearer to each other than that are one
  std::vector<std::string> notes_;
};

/// Whether both have the same shapes with the same BSDFs, and so the same edges.
bool has_same_outlines(const SceneParts& a, const SceneParts& b);

}  // namespace aureole
