// SPDX-License-Identifier: Apache-2.0
// Unidirectional spectral path tracer.
#include <optional>

#include "aureole/integrator/diffraction_parameters.h"
#include "aureole/integrator/medium_notes.h"
#include "aureole/integrator/path/path_walk.h"
#include "aureole/plugin/registry.h"

namespace aureole {
namespace {

class PathIntegrator final : public Integrator {
public:
  explicit PathIntegrator(const Properties& p)
      : Integrator(p), limits_(p), diffraction_(get_diffraction(p)) {}

  SceneNeeds needs() const override { return {diffraction_, true}; }
  Leaves leaves() const override { return leaves_splats(diffraction_) ? Leaves::both : Leaves::pixel; }
  void require_scene(const Scene& scene) const override { require_no_glowing_media(scene, *this); }
  bool shows_light() const override { return true; }
  std::vector<std::string> scene_notes(const Scene& scene) const override { return medium_notes(scene); }
  ReceiverRays receiver_rays() const override { return ReceiverRays::scattered; }
  bool rays_go_behind() const override { return true; }
  bool shows_emitters() const override { return limits_.reaches(1) && !limits_.hide_emitters; }

  void trace(const Scene& scene, std::span<Path> paths, std::vector<Splat>& splats,
             const BatchLog& log) const override {
    for (Path& p : paths) p.result = {};
    if (!limits_.reaches(1)) return;
    const Arena::Frame frame;
    const WalkInput in{scene, limits_, paths, log, frame.arena()};
    if (space_of(scene) == Space::any)
      follow<PathWalk<Space::any>>(in);
    else
      follow<PathWalk<Space::empty>>(in);
    follow_diffracted_paths(in, 1, true, splats, [](const WalkInput& second, const auto& begin) {
      PathWalk<Space::any> walk(second);
      follow_from(second, walk, begin);
    });
  }

private:
  template <class PathWalk>
  static void follow(const WalkInput& in) {
    PathWalk walk(in);
    follow_from_start(in, walk);
  }

  PathLimits limits_;
  std::optional<DiffractionSettings> diffraction_;
};

AUREOLE_PLUGIN(
    PathIntegrator, "integrator", "path",
    PluginDoc{
        "Path tracer: next-event estimation and BSDF sampling combined by spectral multiple importance "
        "sampling.",
        "Kajiya 1986; Veach 1997, chapters 9 and 10; Wilkie et al. 2014, Eq. 8",
        with_diffraction_parameters(
            {{"max_depth", "integer", "", "-1",
              "longest path in segments: 1 shows emitters only, 2 direct light; -1: no limit"},
             {"count_crossings", "boolean", "", "true",
              "crossing a mask or a thin pane counts for `max_depth`, as in Mitsuba's `path`; those of `null` alone "
              "never do. Scenes that name Mitsuba's `volpath` or `volpathmis` have false"},
             {"rr_depth", "integer", "", "5",
              "Russian roulette begins after this many vertices, 1000 at most"},
             {"max_scattering", "integer", "", "-1",
              "paths that media scatter more often do not count: 1 is single scattering; -1: no limit"},
             {"hide_emitters", "boolean", "", "false",
              "camera rays pass through area emitters and see no environment"}}),
        {R"(<integrator type="path"><integer name="max_depth" value="8"/><boolean name="count_crossings" value="false"/><integer name="rr_depth" value="5"/>
    <integer name="max_scattering" value="1"/><boolean name="hide_emitters" value="false"/></integrator>)",
         R"(<integrator type="path"><boolean name="diffraction" value="true"/><string name="diffraction_model" value="beams"/><string name="beam_width" value="50 wavelengths"/></integrator>)"}});

}  // namespace
}  // namespace aureole
