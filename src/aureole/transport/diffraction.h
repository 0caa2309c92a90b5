// SPDX-License-Identifier: Apache-2.0
// Diffraction as the rest of transport uses it: the factor that changes the light of a segment, and the state
// of a path. The walk calls transport/edge_walk.h for paths around edges.
#pragma once

#include "aureole/transport/edge_ledger.h"
#include "aureole/transport/edges.h"

namespace aureole {

/// State of a path in `Space::any`.
using DiffractionState = AfterEdge;

/// The factor by which edges beside a segment of that length from `origin` along `d` change the light that
/// passes it; 1 in scenes without edges that diffract. `key` is for random numbers.
inline Spectrum diffraction_factor(const Scene& scene, const Vec3& origin, const Vec3& d, float length,
                                   const Wavelengths& w, std::uint32_t key) {
  return scene.diffraction() ? left_by_edges(scene, {origin, d, length}, w, key) : Spectrum(1.f);
}

/// Multiplies the passage of a complete segment by its diffraction factor.
inline void apply_diffraction(const Scene& scene, TestSegment& segment, const Wavelengths& w,
                              std::uint32_t key) {
  if (scene.diffraction()) segment.passage *= left_by_edges(scene, LightWay::of(segment), w, key);
}

/// Tests a single connection: true where its far end is visible; `passage` is complete then.
inline bool arrives(const Scene& scene, TestSegment& connection, const Wavelengths& w, std::uint32_t key) {
  if (!is_visible(scene, connection, w)) return false;
  apply_diffraction(scene, connection, w, key);
  return true;
}

}  // namespace aureole
