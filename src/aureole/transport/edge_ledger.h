// SPDX-License-Identifier: Apache-2.0
// Power balance of diffraction: the power that edges diffract is removed from the light that passes beside
// them (docs/diffraction_beams.md).
//
// A point x on an edge diffracts the power E S(x) dl of light of irradiance E, where S is the integral of the
// diffraction coefficient K over directions. That power is removed from the light near x, with a Gaussian G
// across the light as its profile. The removed fraction at a point y is D(y) = integral over edges of S(x)
// G(y - x)/N(x) dl, with N(x) = integral of G(y' - x) over all y' where light passes. So the integral of D
// across the light equals the integral of S over the edges, whatever their shapes. The standard deviation of
// G is 0.6 of the widest sigma of the path's wavelengths, for all of them. Light passes at y where a straight
// line is unoccluded for 3 sigma before and behind y.
#pragma once

#include <cstdint>
#include <span>

#include "aureole/scene/edge/open_ways.h"
#include "aureole/scene/edge/scene_diffraction.h"
#include "aureole/scene/scene.h"
#include "aureole/transport/connection.h"

namespace aureole {

/// A straight segment of a light path, in either direction.
struct LightWay {
  /// The kind of an endpoint: an edge, whose own K includes other edges within 7 sigma, or another vertex,
  /// within 3 sigma of which light does not pass. Edges within these distances remove no light.
  enum class End : std::uint8_t { vertex, edge };

  Vec3 from;
  Vec3 d;        ///< direction, unit length
  float length;  ///< length, which may be infinite
  End begin = End::vertex, end = End::vertex;

  static LightWay of(const TestSegment& c, End begin = End::vertex, End end = End::vertex) {
    return {c.origin, c.d, c.distance(), begin, end};
  }
};

/// Returns an unbiased estimate of the fraction of the light that remains beside the edges along a segment:
/// the product of 1 - D, with D the sum over the edges at one depth. It is 1 far from edges. It may be
/// negative, and in small openings so may its mean (docs/diffraction_beams.md). Equal arguments give equal
/// estimates. The result is 1 in scenes without edges that diffract.
Spectrum left_by_edges(const Scene& scene, const LightWay& way, const Wavelengths& w, std::uint32_t key);

/// Returns an estimate of S [unit of length of the scene] at a point on an edge, for light that travels along
/// `d`, from seven numbers in [0, 1). It is a part of `left_by_edges`, declared for tests.
Spectrum diffracted_at(const SceneEdges& edges, const EdgePoint& x, const Vec3& d,
                       const SceneEdges::Beams& beams, std::span<const float, 7> u);

}  // namespace aureole
