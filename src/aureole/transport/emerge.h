// SPDX-License-Identifier: Apache-2.0
// Where a path that has entered a translucent body leaves it, by the BSSRDF of its surface (bssrdf/bssrdf.h).
//
// Exits are found by rays across a disc (King, Kulla, Conty & Fajardo 2013, "BSSRDF importance sampling"):
// the BSSRDF draws a distance from the entry, which is taken in one of three planes, across the normal or a
// tangent there, and a ray along that axis meets the same shape at some points. A point's density per area is
// the sum over the three axes of the density in their planes times the cosine that projects the surface onto
// it. Of the points on a ray one is chosen, in proportion to what it contributes.
#pragma once

#include "aureole/spectrum/path_density.h"
#include "aureole/transport/batch.h"
#include "aureole/transport/dimensions.h"
#include "aureole/transport/vertex.h"

namespace aureole {

struct Emergence {
  SurfacePoint point;  ///< its surface is the exit of that of the entry
  Spectrum value;      ///< P [1/length^2]
  Spectrum pdf;        ///< per area of the shape and per wavelength [1/length^2]
  float chosen;        ///< probability of this point among those on the ray, the same for all wavelengths
};

/// Random numbers of an emergence: which axis, where in its plane, and a key for the choice on the ray.
struct EmergenceRandom {
  float axis;
  Vec2 place;
  std::uint32_t key;
};

/// Draws where light leaves that has entered at `entry`, a point of a surface that has an exit. `throughput`
/// and `ratio` are those of the path so far, by which points are chosen. False where the ray meets no such
/// point.
bool emerge(const Scene& scene, const SurfacePoint& entry, const Wavelengths& w,
            const EmergenceRandom& random, const Spectrum& throughput, const Spectrum& ratio, Emergence& out);

/// The factor of the path so far, per wavelength.
template <class L, PathStart kStart>
Spectrum throughput_of(const BasicPathDensity<L, kStart>& path) {
  return L::magnitude(path.beta);
}

/// The direction from which a path seems to come where it emerges: outside of both normals alike.
inline Vec3 out_of(const SurfacePoint& exit) { return normalize(exit.ng + exit.shading.n); }

/// The same for a path of that density, whose vertex number `vertex` this is: `density` becomes that at the
/// exit, and `state` that of a ray that has come to it from outside.
template <class Density>
bool emerge(const Scene& scene, const SurfacePoint& entry, const Wavelengths& w, SampleStream& samples,
            int vertex, Density& density, RayState& state, SurfacePoint& exit) {
  const float* pairs = samples.directions(vertex);
  const EmergenceRandom random{get(samples, vertex, Choice::lobe), get(pairs, Pair::scatter),
                               key(samples, vertex, Stream::bsdf)};
  Emergence e;
  if (!emerge(scene, entry, w, random, throughput_of(density), density.r_u, e)) return false;
  density.extend(typename Density::Weight(e.value), e.pdf, false);
  density.survive(e.chosen);
  state.ray.d = -out_of(e.point);
  exit = e.point;
  return true;
}

/// The same for path number `i` of a batch, whose entry is vertices[i] and was vertex number `vertex`: the
/// exit takes the entry's place there and has a number of its own.
template <Space kSpace, class L, class Density>
bool emerge(const Scene& scene, PerPath<BasicVertex<kSpace, L>>& vertices, int i, const Wavelengths& w,
            SampleStream& samples, TransportMode mode, int& vertex, Density& density, RayState& state) {
  SurfacePoint exit;
  if (!emerge(scene, vertices[i].point(), w, samples, ++vertex, density, state, exit)) return false;
  auto& made = vertices.make(i, [&] { return BasicVertex<kSpace, L>(exit, -state.ray.d, w, mode); });
  ++vertex;
  made.prepare(0, state.interiors);
  return true;
}

}  // namespace aureole
