// SPDX-License-Identifier: Apache-2.0
// `EdgeScreens`: how the edges beside a segment hide parts of each other. Where two outlines at different depths cross, each
// of them ends the other one; where they run side by side, each one diffracts the wave of the other.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "aureole/optics/diffraction/boundary_wave.h"
#include "aureole/scene/edge/outline_edges.h"

namespace aureole {

/// An edge beside a segment, with its sides for light that passes it.
struct EdgeBeside {
  EdgePassage passage;
  EdgeSide side;
  bool is_outline;  ///< false where it is no outline of its shape, but light runs along one of its faces
};

class EdgeScreens {
public:
  /// The edges must outlive it.
  EdgeScreens(const OutlineEdges& edges, const EdgeSegment& segment, std::span<const EdgeBeside> beside);

  /// Whether no edge can hide a part of another one: all of them bound one flat sheet.
  bool is_one_sheet() const { return buckets_.empty(); }

  /// Sets the distances from the edge's begin at which edges of other depths cross it in the Fresnel plane, in increasing
  /// order.
  void find_cuts(std::size_t edge, std::vector<double>& cuts) const;

  /// An edge that runs along another one, for light that comes by way of that one.
  struct Screen {
    double
        v;  ///< Fresnel's parameter at a unit wavelength of the light from there on, negative in the shadow
    Double3 beside;     ///< a point just off the edge, on its open side
    double obliquity;   ///< cos(theta/2) of its turn times that at the part, over that of the part alone
    bool is_at_border;  ///< light passes so near to the edge that no visibility test can tell on which side
  };
  /// Returns the screen that shadows light most: between a part of an edge and the segment's end (`is_behind`), or between
  /// the segment's begin and that part.
  std::optional<Screen> find_screen(std::size_t edge, const EdgePassage& part, bool is_behind,
                                    double wavelength) const;

private:
  static constexpr std::size_t kBuckets = 64;
  std::size_t bucket_of(const optics::PlanePoint& p) const;
  template <class Visit>
  void for_each_bucket(std::size_t edge, const Visit& visit) const;
  bool may_hide(std::size_t a, std::size_t b) const;

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
