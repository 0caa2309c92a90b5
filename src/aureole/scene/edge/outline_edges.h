// SPDX-License-Identifier: Apache-2.0
// `OutlineEdges`: the diffraction factor u/u0 of straight segments that pass edges of the scene's shapes
// (optics/diffraction/boundary_wave.h). The detours of paths by way of the edges are exact, so that it holds
// from near the edge to the far field.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <deque>
#include <functional>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "aureole/scene/edge/beam_tree.h"
#include "aureole/scene/edge/detour_line.h"
#include "aureole/scene/edge/diffracting_shapes.h"
#include "aureole/scene/edge/edge_lines.h"
#include "aureole/scene/edge/mesh_edges.h"
#include "aureole/scene/scene_parts.h"
#include "aureole/shape/geometry/double3.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

/// The part of an edge whose points have short detours from a segment.
struct EdgePassage {
  const MeshEdge* edge;
  double begin, end;  ///< distances from edge->a
  double middle;      ///< position of the smallest detour on the edge's whole line
  Double3 p;          ///< point of the part nearest to `middle`, relative to the segment's begin
  Double3 in, out;    ///< unit directions of light from the segment's begin to `p`, and from `p` to its end
  double window;      ///< |v| up to which its contributions count fully; they fade out up to 4/3 of it

  /// Whether the smallest detour is by a point of the edge, and not by a point beyond its ends.
  bool passes_middle() const { return middle > begin && middle < end; }
};

/// The window of Fresnel's parameter |v| within which edges beside a segment count.
struct EdgeWindow {
  double largest;            ///< of edges far in whose shadow the segment passes
  double smallest;           ///< of edges near the segment
  double shortest, longest;  ///< wavelengths

  /// Returns the largest detour inside a window, with the part where contributions fade out.
  double detour(double window) const { return longest * window * window * 4 / 9; }
  /// Returns the window of an edge whose smallest detour has the parameter v at a unit wavelength. Light by way of
  /// points with a larger detour interferes destructively, but for the ends of the edge.
  double of_edge(double v) const {
    constexpr double kBeyond = 1.25;
    return std::clamp(kBeyond * v / std::sqrt(shortest), smallest, largest);
  }
};

/// The open side of an edge and the side of its faces, for light that arrives at the edge and leaves it.
struct EdgeSide {
  Double3 normal;     ///< unit vector perpendicular to edge and light, towards the open side
  Double3 beside;     ///< a point just off the edge, on its open side
  double offset;      ///< distance of `beside` from the edge
  double rounding;    ///< bound of errors of heights above the edge
  bool is_open;       ///< whether the segment passes on the open side
  bool is_at_border;  ///< it passes so near to the edge that only a visibility test decides
  /// `MeshEdge::leg` of the edge
  std::uint8_t leg = 0;

  /// Returns whether the segment is taken to pass on the open side, given whether it is unoccluded.
  bool takes_open(bool is_free) const { return is_at_border ? is_free : is_open; }
};

/// An edge as a wedge of two faces, for light that arrives at a point of it and leaves that point
/// (optics/diffraction/uniform_theory.h).
struct EdgeWedge {
  double n;           ///< angle outside the wedge over pi, 2 for the border of a sheet
  double phi, phi_i;  ///< angles [radians] from the o-face to where light goes and comes from
  double distance;    ///< KP's L, in units of the scene
  double sin_beta;    ///< sine of the angle between light and edge
  DiffractingShapes::Reflection reflection_o, reflection_n;  ///< of the o-face and of the n-face
  Double3 normal_o, normal_n;  ///< unit normals of both faces, towards the light

  /// Returns the same wedge with angles from its n-face.
  EdgeWedge reversed() const {
    const double end = n * std::numbers::pi;
    return {n, end - phi, end - phi_i, distance, sin_beta, reflection_n, reflection_o, normal_n, normal_o};
  }
};

/// Light that arrives at a point of an edge and leaves it.
struct LightByEdge {
  Double3 in, out;     ///< unit directions of travel
  double s_in, s_out;  ///< distances to where it comes from and to where it goes; kInfinity for directions
  double tolerance = 1e-4;  ///< angle by which its directions may lie inside the wedge
};

/// How two edges one behind the other act on a segment together.
struct EdgePairField {
  EdgeSide side1, side2;  ///< for light by way of both
  double v1, v2;          ///< Fresnel's parameters at a unit wavelength, negative in the shadow of each
  double cosine;          ///< of the angle between the edges' normals about the segment
  double r1, between,
      r2;  ///< distances along the segment: to edge 1, from there to edge 2, and on to the end
  double w1,
      w2;  ///< parameters of edge 1 for light to edge 2, and of edge 2 for light from edge 1
  double obliquity1, obliquity2;  ///< cos(theta/2) of paths by way of edge 1 alone and of edge 2 alone
  double turn1, turn2;            ///< cos(theta/2) at edge 1 and at edge 2 of paths by way of both
  double height1;  ///< height above edge 2 of the ray from edge 1 straight to the segment's end
  double height2;  ///< height above edge 1 of the ray from the segment's begin straight to edge 2

  /// Returns the correlation of the edges (`two_edges_field`). Edges closer than a twentieth of the
  /// wavelength count as one edge.
  double correlation(double wavelength) const {
    // The detour by way of both is q/4 = (v1^2 + w2^2)/4 = (v2^2 + w1^2)/4. Its paraxial form is (v1^2 + v2^2
    // - 2 rho v1 v2)/(1 - rho^2)/4; equating both gives rho at large angles.
    const double q = 0.5 * (v1 * v1 + w2 * w2 + v2 * v2 + w1 * w1);
    if (cosine > 0.99 && between > wavelength && q > 0.01 * wavelength)
      return std::clamp((v1 * v2 - w1 * w2) / q, -1.0, 1.0);
    const double apart = std::max(0.0, between - wavelength / 20);
    const double ratio = r1 / (r1 + apart) * r2 / (r2 + apart);
    return cosine * std::sqrt(ratio);
  }
  /// Returns the obliquity factor of the common field: that of the path by way of both edges, or by way of
  /// the one that occludes the other.
  double obliquity() const { return w2 >= 0 ? obliquity1 : w1 >= 0 ? obliquity2 : turn1 * turn2; }
  /// Whether visibility tests by way of single edges agree with half planes. `first_clears`: the ray from
  /// edge 1 to the segment's end passes edge 2; `second_clears`: the ray from the begin to edge 2 passes edge
  /// 1.
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

  /// Calls visit(passage) for the edges with a detour inside the window at wavelengths between `shortest` and
  /// `longest` [unit of length of the scene], of a segment that is unoccluded (`is_open`) or occluded. `rims`
  /// receives the edges of balls, whose outline depends on the segment; passages refer to them.
  template <class Visit>
  void visit(const EdgeSegment& segment, bool is_open, double shortest, double longest,
             std::deque<MeshEdge>& rims, const Visit& visit) const {
    const EdgeWindow window{is_open ? window_open_ : window_behind_, is_open ? window_open_ : window_,
                            shortest, longest};
    const double detour = window.detour(window.largest);
    const auto visit_edge = [&](const MeshEdge& edge) {
      EdgePassage passage;
      if (find_passage(edge, segment, window, passage)) visit(passage);
    };
    visit_lines(segment, detour, [&](std::uint32_t i) { visit_edge(edges_[i]); });
    if (balls_.empty()) return;
    ball_tree_.visit(beam_of(segment, detour), [&](std::uint32_t i) { add_rim(i, segment, detour, rims); });
    for (const MeshEdge& edge : rims) visit_edge(edge);
  }

  /// Whether an edge may have a detour inside the window of an unoccluded segment, at wavelengths up to `longest`. If
  /// not, the diffraction factor of that segment and of those from its begin to a point of it is 1. Most segments have none.
  bool has_near(const EdgeSegment& segment, double longest) const {
    if (!balls_.empty()) return true;
    const double detour = EdgeWindow{window_open_, window_open_, longest, longest}.detour(window_open_);
    return lines_.has_near(segment.from, segment.d, squared_radius(segment, detour));
  }

  /// Returns the smallest Fresnel parameter |v| of paths by way of an irradiated edge beside the segment, at
  /// a wavelength in units of the scene; infinity if it exceeds `most`, or the window if that is smaller.
  /// is_lit(p) tells whether light reaches a point p just beside an edge. It is called for at most 8 edges,
  /// and not for balls: all others count as irradiated.
  double smallest_parameter(double most, const EdgeSegment& segment, double wavelength,
                            const std::function<bool(const Double3&)>& is_lit) const;

  static constexpr std::uint32_t kNoSheet = 0xffffffff;
  /// Returns the number of the flat sheet that an edge bounds, or kNoSheet.
  std::uint32_t sheet_of(const MeshEdge& edge) const { return sheet_[edge.face0.set]; }
  /// Whether both edges bound one flat sheet, so that neither occludes a part of the other.
  bool are_of_one_sheet(const MeshEdge& a, const MeshEdge& b) const {
    const std::uint32_t sheet = sheet_[a.face0.set];
    return sheet != kNoSheet && sheet == sheet_[b.face0.set] && a.leg == b.leg;
  }

  /// Returns the part of a passage between two distances from the edge's begin. `begins_at_cut` and
  /// `ends_at_cut` tell whether another edge crosses it there.
  EdgePassage part(const EdgePassage& passage, const EdgeSegment& segment, double begin, double end,
                   bool begins_at_cut, bool ends_at_cut) const;

  /// Sets the sides of an edge for light that arrives along `in` and leaves along `out`. Returns false if the
  /// edge is no outline of its surface for that light. `grazes`: it also counts if light runs along one of
  /// its faces and the other face is inclined to it.
  bool find_side(const EdgePassage& passage, const EdgeSegment& segment, const Double3& in,
                 const Double3& out, bool grazes, EdgeSide& side) const;

  /// Whether both edges bound one flat face, such as a roof. The passages have their points on them.
  static bool have_common_face(const EdgePassage& a, const EdgePassage& b);

  /// Sets the wedge of an edge for light by way of a point of it. Returns false if the edge acts as that of a half
  /// plane that absorbs: for round bodies, for folds of less than 30 degrees, which approximate curved
  /// surfaces, and if light would arrive or leave inside the wedge.
  bool find_wedge(const MeshEdge& edge, const LightByEdge& light, EdgeWedge& out) const;

  /// Subtracts the boundary wave of an edge from u/u0 at each of `count` wavelengths [unit of length of the
  /// scene]. `takes_open`: the segment is taken to pass on the edge's open side.
  void subtract(const EdgePassage& passage, const EdgeSegment& segment, bool takes_open,
                const double* wavelengths, int count, std::complex<double>* field) const;

  /// Angle from a face up to which light counts as running along it: edges of thin blocks far from the origin have
  /// rounded coordinates.
  static constexpr double kAlongFace = 0.02;
  /// Cosine of the angle between the normals of two edges, perpendicular to the segment, above which they
  /// count as parallel.
  static constexpr double kSideBySide = 0.8;
  /// Sets how two edges act together; the segment passes `first` first. Returns false if they do not act
  /// together: on opposite sides of the segment, in one plane, if they cross or have a common end, or if the
  /// segment passes beyond an end of one.
  bool find_pair(const EdgePassage& first, const EdgePassage& second, const EdgeSegment& segment,
                 EdgePairField& out) const;
  /// An edge of a row of edges that act together.
  struct RowEdge {
    bool is_open;  ///< whether the segment is taken to pass on its open side
    /// The side for which its wave was subtracted from u/u0: true for a segment on its open side, false for
    /// one in its shadow, empty if it was not subtracted.
    std::optional<bool> subtracted;
  };
  /// Replaces the waves of edges one behind the other by their common field: `two_edges_field` of two edges;
  /// for more edges the product of the fields of neighbours over the fields of the inner edges alone.
  /// `pairs[i]` consists of the edges i and i + 1.
  void add_row(std::span<const EdgePairField> pairs, std::span<const RowEdge> row, double factor,
               const double* wavelengths, int count, std::complex<double>* field) const;

  /// Returns the largest |v| up to which edges count.
  double largest_window() const { return window_behind_; }

  /// Returns a wavelength of a path in units of the scene.
  double wavelength(float nm) const { return double(nm) * nm_; }

private:
  /// Returns the distance from an edge of a point beside it, for coordinates with errors up to `rounding`.
  double offset(const MeshEdge& edge, double rounding) const {
    return 2 * (rounding + double(welded_)) + 1.01 * double(lift_[edge.face0.set]);
  }
  /// Returns the squared radius of a cylinder about a segment that contains all points of edges with detours up to
  /// `detour`.
  double squared_radius(const EdgeSegment& s, double detour) const {
    if (!s.is_infinite()) return (detour * detour + 2 * s.length * detour) / 4;
    return detour * detour + 2 * farthest(s) * detour;
  }
  /// Returns a bound of the distance of the edges along a segment of infinite length.
  double farthest(const EdgeSegment& s) const {
    return aureole::length(Double3(box_.center()) - s.from) + 0.5 * double(aureole::length(box_.diagonal()));
  }
  Beam beam_of(const EdgeSegment& segment, double detour) const;
  /// Calls visit(i) for a superset of the edges with points whose detour is at most `detour`.
  template <class Visit>
  void visit_lines(const EdgeSegment& s, double detour, const Visit& visit) const {
    lines_.visit(
        s.from, s.d, squared_radius(s, detour), [&] { return beam_of(s, detour); }, visit);
  }
  /// Returns the squared Fresnel parameter, in the paraxial form, of a ball's outline at a unit wavelength;
  /// infinity if an end of the segment lies on the ball, or if the ball does not lie between the ends.
  double squared_rim_parameter(std::uint32_t ball, const EdgeSegment& segment) const;
  /// Whether a ball's outline may have a detour of at most `detour`; false if an end of the segment lies on
  /// the ball.
  bool has_rim_within(std::uint32_t ball, const EdgeSegment& segment, double detour) const;
  /// Adds the outline of a ball for light along the segment: a polygon around the circle perpendicular to the
  /// segment.
  void add_rim(std::uint32_t ball, const EdgeSegment& segment, double detour,
               std::deque<MeshEdge>& rims) const;
  bool find_passage(const MeshEdge& edge, const EdgeSegment& segment, const EdgeWindow& window,
                    EdgePassage& out) const;

  std::vector<MeshEdge> edges_;
  std::vector<float> lift_;                              ///< of each set of triangles, see DiffractingShapes
  std::vector<DiffractingShapes::Reflection> reflects_;  ///< of each set of triangles
  std::vector<std::uint32_t> sheet_;  ///< of each set of triangles: equal for sets in one plane
  EdgeLines lines_;
  std::vector<DiffractingShapes::BallInWorld> balls_;  ///< their sets follow those of triangles
  BeamTree ball_tree_;
  Bounds3 box_;
  double nm_;
  /// |v| up to which contributions count fully beside unoccluded segments, beside occluded ones, and of edges far in
  /// whose shadow a segment passes. Light on an unoccluded segment is so much brighter than what edges diffract that
  /// a smaller window serves there.
  double window_open_ = 20, window_ = 60, window_behind_ = kLargestWindow;
  static constexpr double kLargestWindow = 400;
  float welded_ = 0;  ///< distance within which vertices are welded
  std::vector<std::string> notes_;
};

/// Whether both scenes have equal shapes with equal BSDFs, and so equal edges.
bool has_same_outlines(const SceneParts& a, const SceneParts& b);

}  // namespace aureole
