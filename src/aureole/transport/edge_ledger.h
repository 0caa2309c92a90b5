// SPDX-License-Identifier: Apache-2.0
// The ledger of diffraction: light that edges send around themselves is missing in what passes beside them
// (docs/diffraction.md).
//
// A place x on an edge diffracts the power E S(x) dl of light of irradiance E, S the integral of K over
// directions. It is taken from light that passes x, in the shape of a Gaussian G across the light: of what
// passes at y the part
//   D(y) = integral over edges of S(x) G(y - x)/N(x) dl,   N(x) = integral of G(y' - x) over all y' where light passes,
// so that the integral of D across the light is that of S over the edges, whatever their shapes. G is .6 of
// the widest sigma of the path's wavelengths wide, for all of them. Light passes at y where a straight way
// goes on for 3 sigma before and behind it. Light "lends" what is missing in it to edges.
#pragma once

#include <cstdint>
#include <span>

#include "aureole/scene/edge/open_ways.h"
#include "aureole/scene/edge/scene_diffraction.h"
#include "aureole/scene/scene.h"
#include "aureole/transport/connection.h"

namespace aureole {

/// A straight way that light takes, in either direction.
struct LightWay {
  /// What the way ends at: an edge, which has others within 7 sigma in its own K, or another vertex, within 3
  /// sigma of which light does not pass. Edges there take nothing.
  enum class End : std::uint8_t { vertex, edge };

  Vec3 from;
  Vec3 d;        ///< unit length
  float length;  ///< may be infinite
  End begin = End::vertex, end = End::vertex;

  static LightWay of(const TestSegment& c, End begin = End::vertex, End end = End::vertex) {
    return {c.origin, c.d, c.distance(), begin, end};
  }
};

/// An unbiased estimate of the product of 1 - D over the edges beside the way, D the sum of those at one
/// depth: the part of the light that they leave. 1 far from edges. It may be negative, and in small openings
/// so may its mean (docs/diffraction.md). Equal arguments give equal estimates. 1 in scenes without edges
/// that diffract.
Spectrum left_by_edges(const Scene& scene, const LightWay& way, const Wavelengths& w, std::uint32_t key);

/// A part of it, for tests: an estimate of S [unit of length of the scene] at a place on an edge, for light
/// that travels along `d`, by seven numbers in [0, 1).
Spectrum diffracted_at(const SceneEdges& edges, const EdgePoint& x, const Vec3& d,
                       const SceneEdges::Beams& beams, std::span<const float, 7> u);

}  // namespace aureole
