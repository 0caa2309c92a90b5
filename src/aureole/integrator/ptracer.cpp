// SPDX-License-Identifier: Apache-2.0
// Light tracing: paths from the lights, connected with the sensor at every vertex. Such a path has one
// technique, and spectral MIS weights it over the wavelengths, whose pdfs differ only by those of its BSDF
// samples. Lights that the sensor sees directly, which no connection finds, are found by rays of the sensor.
#include <limits>

#include "aureole/integrator/diffraction_parameters.h"
#include "aureole/integrator/medium_notes.h"
#include "aureole/integrator/ptracer/particle_walk.h"
#include "aureole/plugin/registry.h"
#include "aureole/transport/line_of_sight.h"

namespace aureole {
namespace {

/// Radiance that the sensor's rays see directly.
class SeenDirectly {
public:
  explicit SeenDirectly(const WalkInput& in)
      : sum(in.arena.make<Spectrum>(in.paths.size(), 0.f)),
        media(in.arena.make<Spectrum>(in.paths.size(), 0.f)),
        scene_(in.scene),
        paths_(in.paths),
        limits_(in.limits) {}
  const Wavelengths& wavelengths(int path) const { return paths_[size_t(path)].wavelengths; }
  void see(int path, const Light& light, const SurfacePoint* point, const Vec3& d, const Spectrum& radiance) {
    if (limits_.hide_emitters) return;  // it hides lights, not media
    float weight = 1;
    if (const Receiver* receiver = paths_[size_t(path)].receiver) {
      const float ray = receiver->pdf(d);
      const float sampled =
          light_density(scene_, {receiver->p, receiver->facing()}, light, point, d, wavelengths(path).time);
      weight = ray / std::max(ray + sampled, std::numeric_limits<float>::min());
    }
    sum[size_t(path)] += radiance * weight;
  }
  void lose(int path) { sum[size_t(path)] = std::numeric_limits<float>::quiet_NaN(); }
  SegmentEmission emission(int) const { return {}; }
  int crossings_before_light(int) const { return limits_.crossings_left(1); }
  void see(int path, const Spectrum& light) {
    media[size_t(path)] += light / paths_[size_t(path)].wavelengths.pdf;
  }

  const std::span<Spectrum> sum;
  const std::span<Spectrum> media;  ///< estimates of the light of media

private:
  const Scene& scene_;
  std::span<Path> paths_;
  const PathLimits& limits_;
};

class ParticleTracer final : public Integrator {
public:
  explicit ParticleTracer(const Properties& p) : Integrator(p), limits_(p), diffraction_(get_diffraction(p)) {
    if (p.has("samples_per_pass"))
      p.note("samples_per_pass", "work is divided by itself: \"samples_per_pass\" has no effect");
    p.get_int("samples_per_pass", -1);
  }

  Leaves leaves() const override { return Leaves::film; }
  SceneNeeds needs() const override { return {diffraction_, true}; }
  void require_scene(const Scene& scene) const override { require_no_glowing_media(scene, *this); }
  std::vector<std::string> scene_notes(const Scene& scene) const override { return medium_notes(scene); }

  ReceiverRays receiver_rays() const override { return ReceiverRays::straight; }
  bool shows_emitters() const override { return limits_.reaches(1) && !limits_.hide_emitters; }

  void trace(const Scene& scene, std::span<Path> paths, std::vector<Splat>& splats,
             const BatchLog& log) const override {
    const Arena::Frame frame;
    const WalkInput in{scene, limits_, paths, log, frame.arena()};
    see_directly(in);
    ParticleWalk<> walk(in, splats);
    if (!limits_.reaches(2) && !walk.counts_beams()) return;
    follow_from_start(in, walk);
    follow_diffracted_paths(in, 1, true, splats, [&](const WalkInput& second, const auto& begin) {
      ParticleWalk<> from_edges(second, splats);
      follow_from(second, from_edges, begin);
    });
  }

private:
  /// Radiance along the sensor's rays that no connection of a light path can bring to the film.
  void see_directly(const WalkInput& in) const {
    const Scene& scene = in.scene;
    const std::span<Path> paths = in.paths;
    const Arena::Frame frame;
    SeenDirectly seen(in);
    DrivenLines<SeenDirectly> lines(in, seen);
    for (size_t i = 0; i < paths.size(); ++i) {
      paths[i].result = {};
      if (!limits_.reaches(1) || !scene.may_meet_emitter(paths[i].ray)) continue;
      if (limits_.hide_emitters && !scene.has_media()) continue;
      RayState start{paths[i].ray, nullptr, {}};
      find_interiors(scene, nullptr, start);
      lines.steps.begin(int(i), start, key(paths[i].samples, -1, Stream::line_of_sight),
                        limits_.hide_emitters);
      lines.driver.rays().add(int(i), paths[i].ray);
    }
    lines.driver.follow(RayTracer::Rays::coherent);
    for (size_t i = 0; i < paths.size(); ++i) {
      if (in.log.follows(int(i)) && !is_black(seen.sum[i]))
        in.log({.kind = PathEvent::Kind::other,
                .estimate = single_estimate(seen.sum[i], paths[i].wavelengths),
                .text = "the sensor sees an emitter"});
      paths[i].result.estimate = single_estimate(seen.sum[i], paths[i].wavelengths) + seen.media[i];
    }
  }

  PathLimits limits_;
  std::optional<DiffractionSettings> diffraction_;
};

AUREOLE_PLUGIN(
    ParticleTracer, "integrator", "ptracer",
    PluginDoc{
        "Light tracing: paths start at the emitters and are connected to the sensor at every vertex. Finds "
        "caustics that a path tracer can't, and shows nothing through smooth glass or in mirrors, since no "
        "connection passes those. Emitters and backgrounds that the sensor sees are found by its own rays. "
        "As "
        "many paths are traced as there are samples on the film.",
        "Veach 1997, section 10.3 (s = 0, 1) with section 5.3 for shading normals; Wilkie et al. 2014, Eq. 8",
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
              "the sensor sees through area emitters and sees no environment"},
             {"samples_per_pass", "integer", "", "-1", "accepted without effect"}}),
        {R"(<integrator type="ptracer"><integer name="max_depth" value="8"/><boolean name="count_crossings" value="false"/><integer name="rr_depth" value="5"/>
    <integer name="max_scattering" value="1"/><boolean name="hide_emitters" value="false"/><integer name="samples_per_pass" value="16"/></integrator>)",
         R"(<integrator type="ptracer"><boolean name="diffraction" value="true"/><string name="diffraction_model" value="beams"/><string name="beam_width" value="fresnel 2m"/></integrator>)"}});

}  // namespace
}  // namespace aureole
