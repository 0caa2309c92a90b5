// SPDX-License-Identifier: Apache-2.0
// Lines of sight: straight rays through null surfaces and media, and the lights that they see.
#pragma once

#include "aureole/transport/driver.h"
#include "aureole/transport/walk_state.h"

namespace aureole {

/// Steps for `Driver`. `Viewer` has
///     const Wavelengths& wavelengths(int path);
///     void lose(int path);                     as in driver.h
///     void see(int path, const Light& light, const SurfacePoint* point, const Vec3& d, const Spectrum& radiance);
///                                              for each light along the ray of direction d: its point (null:
///                                              infinity) and the radiance that arrives
///     SegmentEmission emission(int path);      ratios of pdfs with which the ray finds emission of media
///     void see(int path, const Spectrum& light);
///                                              emission of media that arrives, over the pdfs of finding it
template <class Viewer>
class LinesOfSight {
public:
  LinesOfSight(const Scene& scene, Viewer& viewer, Arena& arena, std::size_t paths)
      : scene_(scene),
        viewer_(viewer),
        lines_(arena.make<TestSegment>(paths).data()),
        keys_(arena.allocate<std::uint32_t>(paths)) {}

  /// Begins the line of sight of a path. `key` is for random numbers.
  void begin(int path, const RayState& start, std::uint32_t key, bool through_emitters = false) {
    TestSegment& line = lines_[path];
    line.set(start.ray);
    line.behind = 0;
    line.through_emitters = through_emitters;
    line.offset = start.offset;
    if (scene_.has_media()) line.begin_in(start, key);
    if constexpr (requires { viewer_.crossings_before_light(path); })
      line.crossings_left = viewer_.crossings_before_light(path);
    keys_[path] = key;
    line.passage = line.clear_passage = 1.f;
  }
  const Ray& ray(int path) const { return lines_[path].ray; }
  void lose(int path) { viewer_.lose(path); }

  Event locate(int path, const RayTracer::Hit& hit) {
    TestSegment& line = lines_[path];
    const Wavelengths& w = viewer_.wavelengths(path);
    const float t = hit ? hit.t : kInfinity;
    if (line.medium) {
      pass_medium(path, line, t, w);
      line.passage *= line.transmitted;
      line.transmitted = 1.f;
      if (is_black(line.passage)) return Event::blocked;
    }
    line.behind += t;
    if (!hit) {
      for (const Light* light : scene_.infinite_emitters())
        viewer_.see(path, *light, nullptr, line.d, arriving(path) * light->eval_escaped(line.d, w));
      return Event::escape;
    }
    return cross(scene_, hit, line, w, [&](const SurfacePoint& point) {
      if (const Light* light = point.surface->light; light && !line.is_inactive(point, w))
        viewer_.see(path, *light, &point, line.d, arriving(path) * light->eval(point, -line.d, w));
    });
  }

private:
  /// Transmittance times diffraction factor from the present hit to the origin of the line of sight.
  Spectrum arriving(int path) const {
    const TestSegment& line = lines_[path];
    return line.passage * diffraction_factor(scene_, line.origin, line.d, line.behind,
                                             viewer_.wavelengths(path), keys_[path]);
  }
  void pass_medium(int path, TestSegment& line, float t_max, const Wavelengths& w) {
    if (!line.medium->emits()) return travel(line, t_max, w);
    SegmentEmission emission = viewer_.emission(path);
    // `travel` multiplies it by the Russian roulette of the whole segment
    const Spectrum before = line.passage;
    travel(line, t_max, w, &emission);
    viewer_.see(path, before * emission.radiance);
  }

  const Scene& scene_;
  Viewer& viewer_;
  TestSegment* const lines_;
  std::uint32_t* const keys_;
};

/// Lines of sight of a walk, with their driver.
template <class Viewer>
struct DrivenLines {
  DrivenLines(const WalkInput& in, Viewer& viewer)
      : steps(in.scene, viewer, in.arena, in.paths.size()),
        driver(in.scene, steps, in.arena, in.paths.size()) {}
  LinesOfSight<Viewer> steps;
  Driver<LinesOfSight<Viewer>> driver;
};

}  // namespace aureole
