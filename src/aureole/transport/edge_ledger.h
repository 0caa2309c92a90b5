// SPDX-License-Identifier: Apache-2.0
// The ledger of diffraction: light that edges send around themselves is missing on the surfaces beside them
// (docs/diffraction.md).
//
// A place x on an edge diffracts the power E S(x) dl of light of irradiance E, S the integral of K over directions. It is taken from
// what falls on the faces about x, in the shape of a Gaussian G across the light: of the light that falls on y the part
//   D(y) = integral over edges of S(x) G(y - x)/N(x) dl,   N(x) = integral of G(y' - x) over the faces that are lit,
// so that the integral of D over the faces is that of S over the edges, whatever their shapes.
#pragma once

#include <cstdint>

#include "aureole/scene/edge/scene_edges.h"
#include "aureole/scene/scene.h"

namespace aureole {

/// False where D is 0 for light from all directions.
bool lends_light(const Scene& scene, const Vec3& y);
/// An unbiased estimate of 1 - D for a place of a surface that has edges (`Surface::lends`) and light that travels along the unit vector
/// `d`: 1 far from edges. It may be negative, and its mean is not. Equal arguments give equal estimates.
Spectrum left_by_edges(const Scene& scene, const Vec3& y, const Vec3& d, const Wavelengths& w,
                       std::uint32_t key);

/// Its parts, for tests. An estimate of S [unit of length of the scene] at a place on an edge, for light that travels along `d`.
Spectrum diffracted_at(const SceneEdges& edges, const EdgePoint& x, const Vec3& d,
                       const SceneEdges::Beams& beams, class KeyedRandom& random);
/// An estimate of 1/N, a number of 1 and more, for a Gaussian of that standard deviation [unit of length of the scene]; 0 where x itself is
/// not lit.
double per_lit_face(const Scene& scene, const EdgePoint& x, const Vec3& d, double deviation,
                    class KeyedRandom& random);

}  // namespace aureole
