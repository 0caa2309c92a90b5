// SPDX-License-Identifier: Apache-2.0
// Subsurface scattering by the BSSRDF of a surface (bssrdf/bssrdf.h): light enters at one point and leaves at
// another.
//
// Exits are sampled by probe rays (King, Kulla, Conty & Fajardo 2013, "BSSRDF importance sampling"). The
// BSSRDF samples a distance from the entry in one of three planes, perpendicular to the normal or a tangent;
// a ray along that axis hits the same shape at some points. A point's pdf per area is the sum over the three
// axes of the pdf in the plane times the cosine of the projection. One of the points on a ray is chosen in
// proportion to its contribution.
#pragma once

#include "aureole/spectrum/path_density.h"
#include "aureole/transport/batch.h"
#include "aureole/transport/dimensions.h"
#include "aureole/transport/vertex.h"

namespace aureole {

struct Emergence {
  SurfacePoint point;  ///< exit point; its surface is `exit` of the surface of entry
  Spectrum value;      ///< value P of the BSSRDF [1/length^2]
  Spectrum pdf;        ///< pdf per area of the shape, per wavelength [1/length^2]
  /// probability of choosing this point among the hits of the probe ray, the same for all wavelengths
  float chosen;
};

/// Random numbers of a BSSRDF exit: `axis` chooses the axis, `place` the position in its plane, and a key the
/// hit on the probe ray.
struct EmergenceRandom {
  float axis;
  Vec2 place;
  std::uint32_t key;
};

/// Samples the exit of light that has entered at `entry`, a point of a surface with a BSSRDF. Points are
/// chosen by `throughput` and `ratio` (`r_u`) of the path so far. False where the probe ray hits no such
/// point.
bool emerge(const Scene& scene, const SurfacePoint& entry, const Wavelengths& w,
            const EmergenceRandom& random, const Spectrum& throughput, const Spectrum& ratio, Emergence& out);

/// Throughput of the path so far, per wavelength.
template <class L, PathStart kStart>
Spectrum throughput_of(const BasicPathDensity<L, kStart>& path) {
  return L::magnitude(path.beta);
}

/// Direction from an exit to the outside of its geometric and its shading normal, which takes the part of the
/// direction to the previous vertex.
inline Vec3 out_of(const SurfacePoint& exit) { return normalize(exit.ng + exit.shading.n); }

/// Samples the exit of a path from its vertex number `vertex`. `density` becomes the density at the exit, and
/// the ray of `state` becomes a ray that arrives at the exit from outside.
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

/// Samples the exit of path number `i` of a batch, whose entry is vertices[i], vertex number `vertex`. The
/// exit replaces it there and has a number of its own.
template <Space kSpace, class L, class Density>
bool emerge(const Scene& scene, PerPath<BasicVertex<kSpace, L>>& vertices, int i, const Wavelengths& w,
            SampleStream& samples, TransportMode mode, int& vertex, Density& density, RayState& state) {
  SurfacePoint exit;
  if (!emerge(scene, vertices[i].point(), w, samples, ++vertex, density, state, exit)) return false;
  auto& made = vertices.make(i, [&] { return BasicVertex<kSpace, L>(exit, -state.ray.d, w, mode); });
  ++vertex;
  made.prepare(0, state);
  return true;
}

}  // namespace aureole
