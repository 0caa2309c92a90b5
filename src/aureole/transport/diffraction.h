// SPDX-License-Identifier: Apache-2.0
// Diffraction as the rest of transport uses it: the factor that changes the light of a segment, and the state
// of a path. The walk calls transport/edge_walk.h for paths around edges.
#pragma once

#include "aureole/transport/edge_ledger.h"
#include "aureole/transport/edges.h"
#include "aureole/transport/segment_diffraction.h"

namespace aureole {

/// State of a path in `Space::any`.
using DiffractionState = AfterEdge;

/// Factor by which edges beside an unoccluded segment of that length from `origin` along `d` change the light
/// along it; 1 in scenes without edges that diffract. `key` is for random numbers.
inline Spectrum diffraction_factor(const Scene& scene, const Vec3& origin, const Vec3& d, float length,
                                   const Wavelengths& w, std::uint32_t key) {
  if (scene.outline_edges()) return segment_diffraction(scene, origin, d, length, true, w);
  return scene.diffraction() ? left_by_edges(scene, {origin, d, length}, w, key) : Spectrum(1.f);
}

/// Multiplies the passage of a connection by its diffraction factor after its visibility test, whose result
/// is `is_open`. Returns true if light arrives. `before`: the chain that the connection continues, or null.
inline bool apply_diffraction(const Scene& scene, TestSegment& segment, bool is_open, const Wavelengths& w,
                              std::uint32_t key, const SegmentChain* before = nullptr) {
  if (scene.outline_edges()) return diffract_connection(scene, segment, is_open, w, before);
  if (is_open && scene.diffraction()) segment.passage *= left_by_edges(scene, LightWay::of(segment), w, key);
  return is_open;
}

/// Tests a single connection: true where light arrives from its far end; `passage` is complete then. `before`: the
/// chain that the connection continues, or null.
inline bool arrives(const Scene& scene, TestSegment& connection, const Wavelengths& w, std::uint32_t key,
                    const SegmentChain* before = nullptr) {
  connection.goes_behind = scene.outline_edges() != nullptr;
  const bool is_open = is_visible(scene, connection, w);
  return apply_diffraction(scene, connection, is_open, w, key, before);
}

}  // namespace aureole
