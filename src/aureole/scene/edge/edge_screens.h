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
  bool is_one_sheet() const { return buckets_.empty(); }

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
  };
  /// Returns the screen nearest to the light between a part of an edge and the segment's end (`towards_end`)
  /// or begin. If the part is visible from there (`is_seen`), light passes the screen on its open side. If it
  /// is not, light passes in the screen's shadow, and is_open(screen) tells whether light by way of the point
  /// beside the screen is unoccluded.
  template <class IsOpen>
  std::optional<Screen> find_screen(std::size_t edge, const EdgePassage& part, bool towards_end, bool is_seen,
                                    double wavelength, const IsOpen& is_open) const {
    std::optional<Screen> found;
    double nearest = kInfinity;
    visit_parallel(edge, part, towards_end, wavelength, [&](const Screen& screen, double distance) {
      if (!(distance < nearest)) return;
      if (!screen.is_at_border && (screen.v < 0) == is_seen) return;
      if (!is_seen && !is_open(screen)) return;
      found = screen, nearest = distance;
    });
    return found;
  }

private:
  static constexpr std::size_t kBuckets = 64;
  std::size_t bucket_of(const optics::PlanePoint& p) const;
  template <class Visit>
  void for_each_bucket(std::size_t edge, const Visit& visit) const;
  bool may_hide(std::size_t a, std::size_t b) const;
  /// Returns the cosine of the angle between the normals of two edges about the segment.
  double cosine(std::size_t a, std::size_t b) const;
  /// Calls visit(screen, distance) for the edges parallel to a part of an edge; the distance is |v|, enlarged
  /// if light passes beyond the screen's ends.
  void visit_parallel(std::size_t edge, const EdgePassage& part, bool towards_end, double wavelength,
                      const std::function<void(const Screen&, double)>& visit) const;

  const OutlineEdges& edges_;
  const EdgeSegment& segment_;
  std::span<const EdgeBeside> beside_;
  Double3 x_, y_;
  std::vector<std::array<optics::PlanePoint, 2>>
      ends_;  ///< ends of each edge in the Fresnel plane of a unit wavelength
  /// The edges that reach into each range of azimuths about the segment; empty if there is one sheet.
  std::vector<std::vector<std::uint32_t>> buckets_;
};

}  // namespace aureole
