// SPDX-License-Identifier: Apache-2.0
// `EdgeScreens`: how the edges beside a segment hide parts of each other. Where two outlines at different depths cross, each
// of them ends the other one; where they run side by side, each one diffracts the wave of the other.
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

/// An edge beside a segment, and on which side of it light is free.
struct EdgeBeside {
  EdgePassage passage;
  EdgeSide side;
  bool is_outline;  ///< false where it is no outline of its shape, but light runs along one of its faces
};

/// Finds for each edge beside a segment which other edges cross it, so that its outline ends there, and which parallel edge
/// diffracts its wave, called its screen.
class EdgeScreens {
public:
  /// The edges must outlive it.
  EdgeScreens(const OutlineEdges& edges, const EdgeSegment& segment, std::span<const EdgeBeside> beside);

  /// Whether no edge can hide a part of another one: all of them bound one flat sheet.
  bool is_one_sheet() const { return buckets_.empty(); }

  /// Sets the distances from the edge's begin at which edges of other depths cross it in the Fresnel plane, in increasing
  /// order.
  void find_cuts(std::size_t edge, std::vector<double>& cuts) const;

  /// Whether a longer edge, or an earlier one of that length, lies on a part of an edge: at its depth, to a twentieth of the
  /// wavelength. Both would have one wave.
  bool is_copy(std::size_t edge, const EdgePassage& part, double wavelength) const;

  /// A parallel edge on the light's way between a part of an edge and one end of the segment.
  struct Screen {
    /// Fresnel's parameter of the screen, at a unit wavelength, for light straight between the part and the end of the segment;
    /// negative in the screen's shadow.
    double v;
    Double3 beside;  ///< a point just off the screen, on its open side
    /// Where light turns at both: the product of cos(theta/2) at the screen and at the part over that at the part alone;
    /// otherwise 1.
    double obliquity;
    bool is_at_border;  ///< light passes so near to the edge that no visibility test can tell on which side
  };
  /// Returns the screen nearest to the light between a part of an edge and the segment's end (`towards_end`) or begin. If the
  /// part is visible from there (`is_seen`), light passes the screen on its open side; if not, in its shadow, and
  /// is_open(screen) tells whether light by way of the point beside it is free.
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
  /// Cosine of the angle between the normals of two edges about the segment.
  double cosine(std::size_t a, std::size_t b) const;
  /// Calls visit(screen, |v| with what light passes beside its ends) for the edges parallel to a part of an edge.
  void visit_parallel(std::size_t edge, const EdgePassage& part, bool towards_end, double wavelength,
                      const std::function<void(const Screen&, double)>& visit) const;

  const OutlineEdges& edges_;
  const EdgeSegment& segment_;
  std::span<const EdgeBeside> beside_;
  Double3 x_, y_;
  std::vector<std::array<optics::PlanePoint, 2>>
      ends_;  ///< of each edge in the Fresnel plane of a unit wavelength
  /// The edges that reach into each range of azimuths about the segment; empty where there is one sheet.
  std::vector<std::vector<std::uint32_t>> buckets_;
};

}  // namespace aureole
