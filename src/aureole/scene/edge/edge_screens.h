// SPDX-License-Identifier: Apache-2.0
// `EdgeScreens`: how the edges beside a segment occlude parts of each other. Where two outlines at different
// depths cross, each of them ends the other; where they run side by side, each one diffracts the wave of the
// other.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "aureole/optics/diffraction/boundary_wave.h"
#include "aureole/optics/lanes.h"
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
    std::uint64_t sheet;            ///< OutlineEdges::sheet_of and leg, or a number of its own
    std::uint32_t sector;           ///< of the azimuth of `across`, of kSectors about the segment
  };
  /// A node of a tree of the lines. Points are relative to the segment's begin.
  struct Node {
    Double3 center;
    double radius;                    ///< of a sphere about the centre that contains the edges
    double nearest, farthest;         ///< their depths along the segment
    optics::PlanePoint lower, upper;  ///< box of the passages in the Fresnel plane
    std::uint32_t first, count;       ///< blocks of a leaf, or the first of two children if count is 0
  };
  static constexpr std::size_t kDepth = 64;  ///< limit of the depth of the tree
  static constexpr std::uint32_t kSectors = 32;
  /// Number of the sheet of a block whose lines bound several sheets.
  static constexpr std::uint64_t kMixed = ~std::uint64_t(0);
  /// Bit in the number that a line which bounds no sheet has instead.
  static constexpr std::uint64_t kAlone = std::uint64_t(1) << 63;
  static constexpr std::uint32_t kLanes = optics::kLanes;
  using LaneVector = std::array<optics::Lanes, 3>;
  /// Lines that are tested together. Unused lanes repeat the last line.
  struct Block {
    LaneVector begin, e, across;  ///< begin of the edge, its direction, and `Line::across`
    optics::Lanes length, depth;
    std::array<optics::Lanes, 2> plane_begin, plane_along;  ///< of the passage, in the Fresnel plane
    std::array<std::uint32_t, kLanes> lines;
    std::uint32_t count = 0;    ///< of different lines
    std::uint32_t sectors = 0;  ///< bits of the sectors of azimuth that contain an `across`
    std::uint64_t sheet = 0;    ///< of all lines, or kMixed

    void set(std::uint32_t lane, const Line& line);
  };
  /// Light between a part of an edge and an end of the segment, for which screens are searched.
  struct Search {
    Double3 from;  ///< its begin relative to that of the segment
    EdgeSegment light;
    Double3 across;  ///< `Line::across` of the part's edge
    double depth, least_depth;
    bool towards_end;
    int side;
  };

  /// Returns the sector of a vector perpendicular to the segment.
  std::uint32_t sector_of(const Double3& across) const;
  void build(std::uint32_t node, std::uint32_t first, std::uint32_t count, std::size_t depth);
  /// Calls visit(block) for the blocks of all leaves whose nodes satisfy enters(node).
  template <class Enters, class Visit>
  void visit(const Enters& enters, const Visit& visit) const;
  /// Returns the distances of the lines of a block from the light, in units of Fresnel's parameter at a unit
  /// wavelength, within rounding; kInfinity for lines that are no screens. `most_beyond`: by how much the light may
  /// pass beyond the ends of a line, in the same units.
  static optics::Lanes distances(const Block& block, const Search& search, double most_beyond);
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
  std::vector<Block> blocks_;
  std::vector<std::uint32_t> order_;  ///< lines in the order of the leaves
  double largest_offset_ = 0;         ///< largest distance from its edge of a point beside an edge
};

}  // namespace aureole
