// SPDX-License-Identifier: Apache-2.0
// MIS of bidirectional path tracing (Veach 1997, chapter 10), in the recursive form of van Antwerpen
// 2011, "Recursive MIS computation for streaming BDPT on the GPU", and Georgiev, Krivanek, Davidovic &
// Slusallek 2012, "Light transport simulation with vertex connection and merging", Eq. 31 to 34, per
// wavelength.
//
// A path x_0 ... x_k from an emitter to the sensor can be found by each technique (s, t), s + t = k + 1: its
// first s vertices by a walk from the emitter, its last t by one from the sensor, and a connection of the
// two. With q_i,j the density of vertex i, had the walk from the emitter found it by wavelength j, and r_i,j
// that of the walk from the sensor, the technique has the density q_0 ... q_(s-1) r_s ... r_k; both walks
// have the same hero. Balanced over techniques and wavelengths, a path found by (s, t) with hero 0 counts f /
// (sum of the densities of all techniques and wavelengths), all over its own density. A subpath keeps the
// sums over the techniques that connect nearer to its beginning, so that each connection knows all of them.
//
// Null collisions are vertices of a path as well: a walk that passes them has a density for them, a
// connection has none.
#pragma once

#include <vector>

#include "aureole/transport/batch.h"
#include "aureole/transport/next_event.h"
#include "aureole/transport/vertex.h"

namespace aureole {

/// Throughput and pdfs of one of the two subpaths. The base's `r_l` is the ratio of the technique that
/// connects the last vertex with the one before it.
template <PathStart kStart, class L = Unpolarised>
struct TwoWayDensity : BasicPathDensity<L, kStart> {
  using Base = BasicPathDensity<L, kStart>;

  /// Sum over the techniques that connect nearer to the start of the subpath, without the pdf of scattering
  /// from the last vertex back to the one before it.
  Spectrum earlier{0.f};

  /// Continues from a vertex. `reverse` is the pdf of scattering back (`Vertex::reverse_pdf`), `across` the
  /// factor of arriving here from the next vertex (`Vertex::density_across`).
  void scatter(const BasicScatter<L>& s, const Spectrum& reverse, const Spectrum& across) {
    const Spectrum connections = s.delta ? reverse * earlier : reverse * earlier + this->r_l;
    earlier = min(min(connections, kMaxPdf) * across * (1 / s.pdf[0]), kMaxPdf);
    Base::extend(s.value, s.pdf, s.delta);
  }
  void pass(const Passage& p) {
    Base::pass(p);
    earlier *= p.flight;
  }
  /// Leaves an edge that diffracts light, for which `extend` was called, in a direction of that pdf. Edges
  /// that one endpoint samples are sampled by no other technique (integrator/bdpt/techniques.h).
  /// `is_connected`: a connection finds the next vertex, too.
  void leave_edge(float pdf, bool is_connected) {
    earlier = 0.f;
    this->r_l = is_connected ? this->r_u * (1 / pdf) : Spectrum(0.f);
  }
  /// Arrives at a vertex. `spread` is the area across the ray per solid angle at the previous vertex, the
  /// squared distance.
  void arrive(bool in_medium, const Spectrum& across, float spread) {
    if (in_medium) {
      // `pass` has divided by the hero's extinction, and has multiplied by the extinction at each wavelength.
      earlier = safe_divide(earlier, across);
      this->r_l *= spread;
    } else {
      const float inverse = across[0] > 0 ? 1 / across[0] : 0.f;
      earlier *= inverse;
      this->r_l *= spread * inverse;
    }
  }

  /// Sum over the techniques that connect nearer to the start of the subpath, given the pdf `reverse` of
  /// scattering back from the last vertex. The caller multiplies it by the pdf of sampling the last vertex
  /// from the other endpoint.
  Spectrum others(const Spectrum& reverse) const { return reverse * earlier + this->r_l; }

private:
  /// Upper bound of a pdf, so that products of many pdfs stay finite.
  static constexpr float kMaxPdf = 1e25f;
};

/// Pdf with which light paths start with the ray of direction `d` from `point` or, that being null, from an
/// emitter without a shape: per area and per solid angle, or masses. `time` [s] is that of the path.
inline float emission_density(const Scene& scene, const Light& light, std::size_t part,
                              const SurfacePoint* point, const Vec3& d, float time) {
  const RayDensity ray = light.pdf_ray(part, point, d, time);
  return scene.lights().probability_by_power(light, part, time) * ray.position * ray.direction;
}

/// The start of a light path.
struct Emission {
  LightChoice choice{};
  EmittedRay ray;

  /// Pdf with which a connection from `from` would have sampled this position on the light: per solid angle,
  /// or the mass of a delta emitter, on a path of that time [s].
  float connection_density(const Scene& scene, const LightReference& from, float time) const {
    const Light& light = *choice.light;
    if (light.is_delta()) return scene.lights().probability(from.p, from.facing, light, choice.part, time);
    SurfacePoint point;
    point.p = ray.p, point.ng = ray.ng, point.time = ray.time;
    return light_density(scene, from, light, choice.part, light.shape ? &point : nullptr, -ray.d, time);
  }
};

template <class L>
using SensorSubpathDensity = TwoWayDensity<PathStart::sensor, L>;
template <class L>
using LightSubpathDensity = TwoWayDensity<PathStart::emitter, L>;

/// A vertex of a light path, kept for connections.
template <class L>
struct LightVertex {
  template <class Make>
  explicit LightVertex(const Make& make) : vertex(make()) {}

  BasicVertex<Space::any, L> vertex;
  LightSubpathDensity<L> density;
  int edges = 0;     ///< segments from the light
  int crossed = 0;   ///< crossings of surfaces since the light that count for the limit of segments
  int in_media = 0;  ///< vertices in media so far, this one included
  int count = 0;     ///< number of vertices that `previous` leads to, this one included
  const LightVertex* previous = nullptr;  ///< previous vertex of the path that may be connected
};

/// Storage of the vertices of a batch of light paths, made in place: earlier ones stay where they are.
template <class L>
class LightVertices {
public:
  LightVertices(Arena& arena, std::size_t paths)
      : arena_(arena), present_(arena.allocate<LightVertex<L>*>(paths)) {}
  template <class Make>
  BasicVertex<Space::any, L>& make(int path, const Make& make) {
    return (present_[path] = new (arena_.allocate<LightVertex<L>>(1)) LightVertex<L>(make))->vertex;
  }
  BasicVertex<Space::any, L>& operator[](int path) { return present_[path]->vertex; }
  /// The present vertex of a path in the batch.
  LightVertex<L>& present(int path) { return *present_[path]; }

private:
  Arena& arena_;
  LightVertex<L>** present_;
};

}  // namespace aureole
