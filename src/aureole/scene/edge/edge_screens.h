// SPDX-License-Identifier: Apache-2.0
// `EdgeScreens`: how the edges beside a segment occlude parts of each other. Where two outlines at different
// depths cross, each of them ends the other; where they run side by side, each one diffracts the wave of the
// other.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "aureole/optics/diffraction/boundary_wave.h"
#include "aureole/scene/edge/outline_edges.h"

namespace aureole {

/// An edge beside a segment, and its open side.
struct EdgeBeside {
  EdgePassage passage;
  EdgeSide side;
  bool is_outline;  ///< false if it is no outline of its shape, but light runs along one of its faces
};

/// Finds for each edge beside a segment the edges that cross it, so that its outline ends there, and the
/// parallel edge that diffracts its wave, called its screen.
class EdgeScreens {
public:
  /// `edges`, `segment` and `beside` must outlive this object.
  EdgeScreens(const OutlineEdges& edges, const EdgeSegment& segment, std::span<const EdgeBeside> beside);

  /// Whether no edge can occlude a part of another one, since all of them bound one flat sheet.
  bool is_one_sheet() const { return is_one_sheet_; }

  /// Sets the distances from the edge's begin at which edges at other depths cross it in the Fresnel plane,
  /// in increasing order.
  void find_cuts(std::size_t edge, std::vector<double>& cuts) const;

  /// Whether a longer edge, or an earlier one of equal length, coincides with a part of this edge, at the
  /// same depth to a twentieth of the wavelength. Both edges have one wave, which counts once.
  bool is_copy(std::size_t edge, const EdgePassage& part, double wavelength) const;

  /// A parallel edge between a part of an edge and one end of the segment.
  struct Screen {
    /// Fresnel's parameter of the screen, at a unit wavelength, for light straight between the part and the
    /// end of the segment; negative in the screen's shadow.
    double v;
    Double3 beside;  ///< a point just off the screen, on its open side
    /// If light turns at both: the product of cos(theta/2) at the screen and at the part, over that at the
    /// part alone; otherwise 1.
    double obliquity;
    bool is_at_border;  ///< light passes so near to the edge that a visibility test cannot tell the side
    bool is_touched;    ///< the distance of light from the edge is within rounding errors
    std::size_t edge;   ///< index of the screen's edge
  };
  /// Returns the screen nearest to the light between a part of an edge and the segment's end (`towards_end`)
  /// or begin. If the part is visible from there (`is_seen`), light passes the screen on its open side. If it
  /// is not, light passes in the screen's shadow, and is_open(screen) tells whether light by way of the point
  /// beside the screen is unoccluded. It takes O(log n) for n edges beside the segment, if few of them are
  /// near the light. `side`: 1 or -1 for screens with the same or with the opposite open side as the edge, about the
  /// segment; 0 for both.
  std::optional<Screen> find_screen(std::size_t edge, const EdgePassage& part, bool towards_end, bool is_seen,
                                    int side, double wavelength,
                                    const std::function<bool(const Screen&)>& is_open) const;

private:
  /// The line of an edge beside the segment.
  struct Line {
    DetourLine line;
    Double3 across;                 ///< unit vector of its open side, perpendicular to the segment
    double depth;                   ///< of the passage's point, along the segment
    optics::PlanePoint begin, end;  ///< of the passage, in the Fresnel plane of a unit wavelength
  };
  /// A node of a tree of the lines. Points are relative to the segment's begin.
  struct Node {
    Double3 center;
    double radius;                    ///< of a sphere about the centre that contains the edges
    double nearest, farthest;         ///< their depths along the segment
    optics::PlanePoint lower, upper;  ///< box of the passages in the Fresnel plane
    std::uint32_t first, count;       ///< lines in `order_`, or the first of two children if count is 0
  };
  static constexpr std::size_t kDepth = 64;  ///< limit of the depth of the tree

  void build(std::uint32_t node, std::uint32_t first, std::uint32_t count, std::size_t depth);
  /// Calls visit(line) for the lines of all leaves whose nodes satisfy enters(node).
  template <class Enters, class Visit>
  void visit(const Enters& enters, const Visit& visit) const;
  bool may_hide(std::size_t a, std::size_t b) const;
  /// Returns the cosine of the angle between the normals of two edges about the segment.
  double cosine(std::size_t a, std::size_t b) const { return dot(lines_[a].across, lines_[b].across); }

  const OutlineEdges& edges_;
  const EdgeSegment& segment_;
  std::span<const EdgeBeside> beside_;
  Double3 x_, y_;
  bool is_one_sheet_ = true;
  std::vector<Line> lines_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;  ///< lines in the order of the leaves
  double largest_offset_ = 0;         ///< largest distance from its edge of a point beside an edge
};

}  // namespace aureole
