// SPDX-License-Identifier: Apache-2.0
// Lines of sight: straight rays through passable surfaces, and the lights that they see.
#pragma once

#include "aureole/transport/driver.h"
#include "aureole/transport/edge_ledger.h"

namespace aureole {

/// Steps for `follow`. `Viewer` has
///     const Wavelengths& wavelengths(int path);
///     void lose(int path);                                as in driver.h
///     void see(int path, const Light& light, const SurfacePoint* point, const Vec3& d, const Spectrum&
///     radiance);
/// which is called for each light along the ray of direction d: with its point (null if it is at infinity)
/// and the part of its radiance that arrives; and perhaps
///     Glow glow(int path);                                densities with which the ray meets emission
///     void see(int path, const Spectrum& light);          what of it arrives, over those of finding it
/// for the light of media along the ray.
template <class Viewer>
class SightSteps {
public:
  SightSteps(const Scene& scene, Viewer& viewer) : scene_(scene), viewer_(viewer) {}

  /// `factor` multiplies the radiance. `key` is for random numbers.
  void begin(int path, const Flight& flight, const Spectrum& factor, std::uint32_t key,
             bool through_emitters = false) {
    lines_[path].set(flight.ray);
    lines_[path].through_emitters = through_emitters;
    if (scene_.has_media()) lines_[path].begin_in(flight, key);
    keys_[path] = key;
    lines_[path].light = factor;
  }
  const Ray& ray(int path) const { return lines_[path].flight.ray; }
  void lose(int path) { viewer_.lose(path); }

  Event arrive(int path, const RayTracer::Hit& hit) {
    Connection& line = lines_[path];
    const Wavelengths& w = viewer_.wavelengths(path);
    if (line.flight.medium) {
      go_through_medium(path, line, hit ? hit.t : kInfinity, w);
      line.light *= line.passed;
      line.passed = 1.f;
      if (is_black(line.light)) return Event::blocked;
    }
    lend_to_edges(scene_, {line.flight.ray.o, line.d, hit ? hit.t : kInfinity}, w, keys_[path], line.light);
    if (!hit) {
      for (const Light* light : scene_.infinite_emitters())
        viewer_.see(path, *light, nullptr, line.d, line.light * light->eval_escaped(line.d, w));
      return Event::escape;
    }
    const SurfacePoint point = scene_.surface_point(hit, line.flight.ray);
    if (const Light* light = point.surface->light; light && !line.flight.is_hidden(*point.surface))
      viewer_.see(path, *light, &point, line.d, line.light * light->eval(point, -line.d, w));
    return cross(point, line, w);
  }

private:
  void go_through_medium(int path, Connection& line, float t_max, const Wavelengths& w) {
    if constexpr (requires { viewer_.glow(0); })
      if (line.flight.medium->emits()) {
        Glow glow = viewer_.glow(path);
        const Spectrum before = line.light;  // `travel` puts the roulette of the whole way into it
        travel(line, t_max, w, &glow);
        return viewer_.see(path, before * glow.seen);
      }
    travel(line, t_max, w);
  }

  const Scene& scene_;
  Viewer& viewer_;
  Connection lines_[kBatch];
  std::uint32_t keys_[kBatch];
};

}  // namespace aureole
