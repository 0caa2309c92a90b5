// SPDX-License-Identifier: Apache-2.0
// Lines of sight: straight rays through passable surfaces, and the lights that they see.
#pragma once

#include "aureole/transport/driver.h"
#include "aureole/transport/keyed_random.h"

namespace aureole {

/// Steps for `follow`. `Viewer` has
///     const Wavelengths& wavelengths(int path);
///     void lose(int path);                                as in driver.h
///     void see(int path, const Light& light, const SurfacePoint* point, const Vec3& d, const Spectrum&
///     radiance);
/// which is called for each light along the ray of direction d: with its point (null if it is at infinity)
/// and the part of its radiance that arrives; and perhaps
///     void glow(int path, const Spectrum& estimate);
/// for the light of media along the ray, divided by the density of its wavelengths.
template <class Viewer>
class SightSteps {
public:
  SightSteps(const Scene& scene, Viewer& viewer) : scene_(scene), viewer_(viewer) {}

  /// `factor` multiplies the radiance. `key` is for random numbers.
  void begin(int path, const Flight& flight, const Spectrum& factor, std::uint32_t key) {
    lines_[path].set(flight.ray);
    if (scene_.has_media()) lines_[path].begin_in(flight, key);
    lines_[path].light = factor;
  }
  const Ray& ray(int path) const { return lines_[path].flight.ray; }
  void lose(int path) { viewer_.lose(path); }

  Event arrive(int path, const RayTracer::Hit& hit) {
    Connection& line = lines_[path];
    const Wavelengths& w = viewer_.wavelengths(path);
    if (line.flight.medium) {
      if constexpr (requires { viewer_.glow(0, Spectrum()); })
        if (line.flight.medium->emits()) viewer_.glow(path, glow(line, hit ? hit.t : kInfinity, w));
      travel(line, hit ? hit.t : kInfinity, w);
      line.light *= line.passed;
      line.passed = 1.f;
      if (is_black(line.light)) return Event::blocked;
    }
    if (!hit) {
      for (const Light* light : scene_.infinite_emitters())
        viewer_.see(path, *light, nullptr, line.d, line.light * light->eval_escaped(line.d, w));
      return Event::escape;
    }
    const SurfacePoint point = scene_.surface_point(hit, line.flight.ray);
    if (const Light* light = point.surface->light)
      viewer_.see(path, *light, &point, line.d, line.light * light->eval(point, -line.d, w));
    return cross(point, line, w);
  }

private:
  static Spectrum glow(const Connection& line, float t_max, const Wavelengths& w) {
    KeyedRandom random(line.key);
    const FlightRandom numbers{random.next(), line.key + 1};
    Glow seen{1.f, 0.f, nullptr, {}};
    Passage passage;
    float t;
    fly(*line.flight.medium, line.flight.ray, t_max, w, numbers, passage, &seen, t);
    return line.light * seen.seen / w.pdf;
  }

  const Scene& scene_;
  Viewer& viewer_;
  Connection lines_[kBatch];
};

}  // namespace aureole
