// SPDX-License-Identifier: Apache-2.0
// A small scene with textures of everything a job touches: border-crossing filter, glass, dispersion, area
// and point lights.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "aureole/render/job.h"

namespace aureole::test {

inline std::string small_scene_text(int width = 40, int height = 28, const std::string& extra_film = "") {
  return R"(<scene version="3.0.0">
<integrator type="path"><integer name="max_depth" value="7"/></integrator>
<sensor type="perspective"><float name="fov" value="45"/>
  <transform name="to_world"><lookat origin="0, 1.2, 4" target="0, 0.5, 0" up="0, 1, 0"/></transform>
  <sampler type="sobol"><integer name="sample_count" value="48"/></sampler>
  <film type="hdrfilm"><integer name="width" value=")" +
         std::to_string(width) + R"("/><integer name="height" value=")" + std::to_string(height) +
         R"("/><string name="component_format" value="float32"/>
    <string name="pixel_format" value="rgba"/><rfilter type="gaussian"/>)" +
         extra_film + R"(</film></sensor>
<shape type="rectangle"><transform name="to_world"><scale value="3"/><rotate x="1" angle="-90"/></transform>
  <bsdf type="diffuse"><texture name="reflectance" type="checkerboard"><transform name="to_uv"><scale value="6"/></transform></texture></bsdf></shape>
<shape type="sphere"><point name="center" x="-0.6" y="0.6" z="0"/><float name="radius" value="0.55"/><bsdf type="dielectric"><string name="int_ior" value="bk7"/></bsdf></shape>
<shape type="sphere"><point name="center" x="0.7" y="0.5" z="0.2"/><float name="radius" value="0.45"/><bsdf type="plastic"><rgb name="diffuse_reflectance" value="0.7, 0.2, 0.1"/></bsdf></shape>
<shape type="rectangle"><transform name="to_world"><scale value="0.5"/><rotate x="1" angle="90"/><translate y="2.5"/></transform>
  <emitter type="area"><rgb name="radiance" value="8, 7, 5"/></emitter></shape>
<emitter type="point"><point name="position" x="2" y="2" z="2"/><rgb name="intensity" value="1, 2, 3"/></emitter>
<emitter type="constant"><rgb name="radiance" value="0.05, 0.07, 0.1"/></emitter>
</scene>)";
}

inline LoadedScene small_scene(int width = 40, int height = 28, const std::string& extra_film = "") {
  return load_scene_from_string(small_scene_text(width, height, extra_film), "small.xml");
}

inline bool same_bits(const RenderState& a, const RenderState& b) {
  const auto differ = [](const std::vector<FilmBuffer>& of_a, const std::vector<FilmBuffer>& of_b) {
    return !std::equal(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(),
                       [](const FilmBuffer& x, const FilmBuffer& y) { return x.data() == y.data(); });
  };
  if (differ(a.films, b.films) || differ(a.splats, b.splats)) return false;
  return a.picture().pixels == b.picture().pixels;
}

/// Renders a job to its end through its state file, stopped again and again, each time after little work.
/// Calls `use` with the finished job and returns how often it was interrupted.
inline int render_interrupted(const LoadedScene& scene, const RenderOptions& options,
                              const std::function<void(const RenderJob&)>& use) {
  for (int interruptions = 0;; ++interruptions) {
    RenderJob job(scene, options);
    if (std::filesystem::exists(options.state_file)) job.resume(RenderState::load(options.state_file));
    std::atomic<bool> stop{false};
    std::thread breaker([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      stop = interruptions < 5;
    });
    const RenderJob::Outcome outcome = job.run(stop);
    breaker.join();
    if (outcome != RenderJob::Outcome::finished) continue;
    use(job);
    return interruptions;
  }
}

}  // namespace aureole::test
