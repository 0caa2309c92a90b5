// SPDX-License-Identifier: Apache-2.0
// Bidirectional path tracing: a path from an emitter and one from the sensor, each vertex of one connected with each
// of the other. All techniques by which a path can be found count, by spectral MIS (transport/two_way.h).
#include <array>
#include <optional>

#include "aureole/bsdf/near_field.h"
#include "aureole/integrator/bdpt/light_steps.h"
#include "aureole/integrator/bdpt/sensor_steps.h"
#include "aureole/integrator/diffraction_parameters.h"
#include "aureole/plugin/registry.h"

namespace aureole {
namespace {

/// Steps of the driver: the connections of the sensor's subpaths with one vertex of each path of light, from the
/// last one of each on.
class InnerConnections {
public:
  /// `light`: the paths of light by their last vertices, or null where there are none.
  InnerConnections(bdpt::SensorSteps& sensor, const bdpt::LightSteps* light)
      : sensor_(sensor), light_(light) {}

  /// All of them at the vertices where some of the paths are.
  void make(const Scene& scene, const PathList& vertices, BatchConnections& connections) {
    if (!light_) return;
    PathList rest;
    for (const int path : vertices) {
      ends_[path] = light_->last_vertex(path);
      if (ends_[path] && sensor_.is_connectable(path)) rest.add(path);
    }
    while (rest.count > 0) {
      connect_all(scene, *this, rest, connections);
      PathList next;
      for (const int path : rest)
        if ((ends_[path] = ends_[path]->previous)) next.add(path);
      rest = next;
    }
  }

  bool connect(int path, Connection& out) { return sensor_.connect(path, *ends_[path], out); }
  bool needs_march() const { return sensor_.needs_march(); }
  void connected(int path, const Connection& c, bool open) { sensor_.connected(path, c, open); }
  const Wavelengths& wavelengths(int path) const { return sensor_.wavelengths(path); }
  std::uint32_t connection_key(int path) const { return sensor_.connection_key(path); }

private:
  bdpt::SensorSteps& sensor_;
  const bdpt::LightSteps* light_;
  const bdpt::LightVertex* ends_[kBatch];
};

class BidirectionalPathTracer final : public Integrator {
public:
  explicit BidirectionalPathTracer(const Properties& p)
      : Integrator(p),
        settings_{PathLimits(p),
                  {int(p.get_int("strategy_s", -1, {-1, 1e9})), int(p.get_int("strategy_t", -1, {-1, 1e9}))}},
        diffraction_(get_diffraction(p)) {
    const auto& [s, t] = settings_.techniques;
    if (t == 0)
      throw p.error("strategy_t",
                    "a sensor's aperture is no surface that light could meet: expected 1 or more");
    if (t == 1 && (s == 0 || s == 1))
      throw p.error("strategy_s", "what the sensor sees directly is found with two vertices from the sensor");
  }

  Leaves leaves() const override { return Leaves::both; }
  SceneNeeds needs() const override { return {diffraction_}; }
  bool shows_emitters() const override {
    return settings_.limits.reaches(1) && !settings_.limits.hide_emitters && settings_.techniques.have(1, 1);
  }
  void require_scene(const Scene& scene) const override {
    require_no_glowing_media(scene, *this);
    if (scene.has_exits())
      throw Error(
          properties().where(),
          "\"bdpt\" does not follow light below surfaces with a BSSRDF: use \"path\" or \"ptracer\", or a "
          "medium inside the shape");
    const auto refuse_fibres = [](const Bsdf& bsdf) {
      if (has(bsdf.lobes(), kNearField))
        throw Error(bsdf.properties().where(),
                    "\"bdpt\" cannot walk backwards through fibres of hair: use \"path\" or \"ptracer\"");
    };
    for (const Primitive& part : scene.parts().surfaces) {
      if (part.bsdf) refuse_fibres(*part.bsdf);
      if (part.instance)
        for (const BsdfPtr& bsdf : part.instance->list().bsdfs) refuse_fibres(*bsdf);
    }
  }

  void trace(const Scene& scene, std::span<Path> paths, std::vector<Splat>& splats,
             const BatchLog& log) const override {
    for (Path& p : paths) p.result = {};
    BatchRays rays;
    std::optional<bdpt::LightSteps> light;
    const bool has_light = settings_.limits.reaches(2) && settings_.techniques.need_light();
    if (has_light) {
      light.emplace(scene, settings_, paths, splats, log);
      for (size_t i = 0; i < paths.size(); ++i)
        if (light->emit(int(i))) rays.add(int(i), light->ray(int(i)));
      follow(scene, *light, rays, RayTracer::Rays::incoherent);
    }
    if (!settings_.limits.reaches(1)) return;
    if (scene.edges() && !scene.edges()->empty())
      return follow_with_edges(scene, paths, light ? &*light : nullptr, splats, log);
    bdpt::SensorSteps sensor(scene, settings_, paths, log);
    for (size_t i = 0; i < paths.size(); ++i) rays.add(int(i), paths[i].ray);
    follow_sensor(scene, sensor, light ? &*light : nullptr, rays, RayTracer::Rays::coherent);
  }

private:
  /// Paths of the sensor, with all their connections.
  static void follow_sensor(const Scene& scene, bdpt::SensorSteps& sensor, const bdpt::LightSteps* light,
                            BatchRays& rays, RayTracer::Rays kind) {
    InnerConnections inner(sensor, light);
    BatchConnections connections;
    for (; !rays.empty(); kind = RayTracer::Rays::incoherent) {
      const PathList vertices = arrive_all(scene, sensor, rays, kind);
      connect_all(scene, sensor, vertices, connections);
      sensor.connect_around_edges(vertices);
      inner.make(scene, vertices, connections);
      scatter_all(sensor, vertices, rays);
    }
  }

  /// The same in scenes with edges that diffract, with paths that begin there.
  [[gnu::noinline]] void follow_with_edges(const Scene& scene, std::span<Path> paths,
                                           const bdpt::LightSteps* light, std::vector<Splat>& splats,
                                           const BatchLog& log) const {
    BatchRays rays;
    std::optional<bdpt::LightSteps> from_edges;
    if (light && bdpt::LightSteps::finds_edges(scene)) {
      from_edges.emplace(scene, settings_, paths, splats, log);
      for (size_t i = 0; i < paths.size(); ++i)
        if (from_edges->begin_at_edge(int(i), light->last_vertex(int(i))))
          rays.add(int(i), from_edges->ray(int(i)));
      follow(scene, *from_edges, rays, RayTracer::Rays::incoherent);
      light = &*from_edges;
    }
    {
      bdpt::SensorSteps sensor(scene, settings_, paths, log);
      for (size_t i = 0; i < paths.size(); ++i) {
        if (light) sensor.put_light(int(i), light->last_vertex(int(i)));
        rays.add(int(i), paths[i].ray);
      }
      follow_sensor(scene, sensor, light, rays, RayTracer::Rays::coherent);
    }
    if (!settings_.limits.reaches(2)) return;

    // Light that reaches the sensor from edges, wherever they are on the film.
    std::array<Path, kBatch> seen;
    std::array<Vec2, kBatch> film;
    for (size_t i = 0; i < paths.size(); ++i) {
      seen[i] = paths[i];
      seen[i].samples = paths[i].samples.of_second_path().of_second_path().of_second_path();
      seen[i].result = {};
    }
    const std::span<Path> second(seen.data(), paths.size());
    bdpt::SensorSteps sensor(scene, settings_, second, log);
    for (size_t i = 0; i < paths.size(); ++i) {
      film[i] = {-1, -1};
      if (light) sensor.put_light(int(i), light->last_vertex(int(i)));
      if (settings_.techniques.have(1, 2))
        if (const auto splat =
                light_seen_around_edge(scene, int(i), paths[i], settings_.limits.hide_emitters))
          splats.push_back(*splat);
      if (sensor.begin_at_edge(int(i), film[i])) rays.add(int(i), sensor.ray(int(i)));
    }
    follow_sensor(scene, sensor, light, rays, RayTracer::Rays::incoherent);
    for (size_t i = 0; i < paths.size(); ++i)
      if (!is_black(seen[i].result.estimate)) splats.push_back({int(i), film[i], seen[i].result.estimate});
  }

  bdpt::Settings settings_;
  std::optional<BeamWidth> diffraction_;
};

AUREOLE_PLUGIN(
    BidirectionalPathTracer, "integrator", "bdpt",
    PluginDoc{
        "Bidirectional path tracing: a path from an emitter and one from the sensor are connected in every way, and "
        "all ways to find a path are weighted by spectral multiple importance sampling. Finds caustics and light "
        "that reaches the scene through small openings or by detours; a sample takes several times as long as one of "
        "`path`, and in dense media, where both parts are long and each vertex is connected with each, far longer: "
        "use `path` there. With `diffraction` each edge is found from one end only: from the lamp if a mirror or smooth glass "
        "comes next after it, else from the sensor (docs/diffraction.md).",
        "Veach 1997, chapter 10; Georgiev et al. 2012, Eq. 31 to 34 (recursive weights); Wilkie et al. 2014, Eq. 8",
        with_diffraction_parameters(
            {{"max_depth", "integer", "", "-1",
              "longest path in edges: 1 shows emitters only, 2 direct light; -1: no limit"},
             {"rr_depth", "integer", "", "5",
              "Russian roulette begins after this many vertices of either part of a path, 1000 at most"},
             {"max_scattering", "integer", "", "-1",
              "paths that media scatter more often do not count: 1 is single scattering; -1: no limit"},
             {"hide_emitters", "boolean", "", "false",
              "the sensor sees through area emitters and sees no environment"},
             {"strategy_s", "integer", "vertices", "-1",
              "to look at single techniques: only paths with so many vertices from the emitter count, unweighted. 0: "
              "emitters that the sensor's path meets, 1: its connections with lights, 2 and more: with paths of light; "
              "-1: any"},
             {"strategy_t", "integer", "vertices", "-1",
              "the same of the vertices from the sensor, itself included. 1: connections of paths of light with the "
              "sensor; -1: any"}}),
        {R"(<integrator type="bdpt"><integer name="max_depth" value="8"/><integer name="rr_depth" value="5"/>
    <integer name="max_scattering" value="1"/><boolean name="hide_emitters" value="false"/></integrator>)",
         R"(<integrator type="bdpt"><integer name="strategy_s" value="2"/><integer name="strategy_t" value="2"/></integrator>)",
         R"(<integrator type="bdpt"><boolean name="diffraction" value="true"/><string name="beam_width" value="50 wavelengths"/></integrator>)"}});

}  // namespace
}  // namespace aureole
