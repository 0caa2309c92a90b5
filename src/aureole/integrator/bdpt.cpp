// SPDX-License-Identifier: Apache-2.0
// Bidirectional path tracing: each vertex of a path from an emitter is connected with each vertex of a path
// from the sensor. All techniques by which a path can be found count, by spectral MIS (transport/two_way.h).
#include <optional>

#include "aureole/bsdf/near_field.h"
#include "aureole/integrator/bdpt/light_walk.h"
#include "aureole/integrator/bdpt/sensor_walk.h"
#include "aureole/integrator/diffraction_parameters.h"
#include "aureole/integrator/medium_notes.h"
#include "aureole/plugin/registry.h"

namespace aureole {
namespace {

using LightWalk = bdpt::LightWalk<Unpolarised>;
using SensorWalk = bdpt::SensorWalk<Unpolarised>;

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
  SceneNeeds needs() const override { return {diffraction_, true}; }
  ReceiverRays receiver_rays() const override {
    return settings_.techniques.are_weighted() ? ReceiverRays::scattered : ReceiverRays::unweighted;
  }
  bool shows_emitters() const override {
    return settings_.limits.reaches(1) && !settings_.limits.hide_emitters && settings_.techniques.have(1, 1);
  }
  std::vector<std::string> scene_notes(const Scene& scene) const override { return medium_notes(scene); }
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
    const Arena::Frame frame;
    const WalkInput in{scene, settings_.limits, paths, log, frame.arena()};
    std::optional<LightWalk> light, light_from_edges;
    const LightWalk* last_light = nullptr;
    if (settings_.limits.reaches(2) && settings_.techniques.need_light()) {
      light.emplace(in, settings_.techniques, splats);
      follow_from_start(in, *light);
      last_light = &*light;
    }
    if (!settings_.limits.reaches(1)) return;
    if (light)
      follow_diffracted_light_paths<LightWalk>(in, [&](const auto& begin) {
        light_from_edges.emplace(in, settings_.techniques, splats, 2, &*light);
        follow_from(in, *light_from_edges, begin);
        last_light = &*light_from_edges;
      });
    SensorWalk walk(in, settings_.techniques, last_light);
    follow_from_start(in, walk);
    follow_diffracted_paths(in, 3, settings_.techniques.have(1, 2), splats,
                            [&](const WalkInput& second, const auto& begin) {
                              SensorWalk from_edges(second, settings_.techniques, last_light);
                              follow_from(second, from_edges, begin);
                            });
  }

private:
  bdpt::Settings settings_;
  std::optional<DiffractionSettings> diffraction_;
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
              "longest path in segments: 1 shows emitters only, 2 direct light; -1: no limit"},
             {"count_crossings", "boolean", "", "true",
              "crossing a mask or a thin pane counts for `max_depth`, as in Mitsuba's `path`; those of `null` alone "
              "never do. Scenes that name Mitsuba's `volpath` or `volpathmis` have false"},
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
        {R"(<integrator type="bdpt"><integer name="max_depth" value="8"/><boolean name="count_crossings" value="false"/><integer name="rr_depth" value="5"/>
    <integer name="max_scattering" value="1"/><boolean name="hide_emitters" value="false"/></integrator>)",
         R"(<integrator type="bdpt"><integer name="strategy_s" value="2"/><integer name="strategy_t" value="2"/></integrator>)",
         R"(<integrator type="bdpt"><boolean name="diffraction" value="true"/><string name="diffraction_model" value="beams"/><string name="beam_width" value="50 wavelengths"/></integrator>)"}});

}  // namespace
}  // namespace aureole
