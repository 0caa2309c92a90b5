// SPDX-License-Identifier: Apache-2.0
// Direct illumination only, with chosen numbers of light and BSDF samples.
#include "aureole/integrator/diffraction_parameters.h"
#include "aureole/integrator/medium_notes.h"
#include "aureole/plugin/registry.h"
#include "aureole/transport/line_of_sight.h"
#include "aureole/transport/walk.h"

namespace aureole {
namespace {

/// Further state of a path.
struct DirectState {
  PathDensity sampled;  ///< density of a path that continues in a direction sampled by the BSDF
  int dimension = 0;    ///< next dimension of the sampler
};

struct DirectKind {
  using L = Unpolarised;
  static constexpr Space kSpace = Space::any;
  static constexpr bool kEmerges = false, kScattersInMedia = false;
  using Density = PathDensity;
  using State = DirectState;
  using Vertices = PerPath<Vertex>;
};

/// Finds the surfaces that the sensor's rays hit and cross, and takes light and BSDF samples there. Media
/// absorb and emit but do not scatter: their transmittance is part of no pdf.
class DirectWalk : public Walk<DirectWalk, DirectKind> {
public:
  DirectWalk(const WalkInput& in, int light_samples, int bsdf_samples)
      : Walk(in),
        media_(connected_media(in.scene)),
        light_samples_(light_samples),
        bsdf_samples_(bsdf_samples),
        counts_{float(light_samples), float(bsdf_samples)},
        lights_(in.arena, in.paths.size()),
        lines_(in, *this) {}

  bool start(int i) {
    begin_at_sensor(i);
    return true;
  }

  // Next-event estimation: light samples and, between them, samples of media that emit.
  int connection_count(int) const { return light_samples_ * (media_ ? 2 : 1); }
  void choose(int i, int k) {
    lights_.make(i, [&]() -> LightSample {
      if (!has_connection(i, k) || is_in_medium(k) || scene_.lights().empty()) return {};
      SampleStream& samples = path(i).samples;
      const int first = states_[i].dimension;
      return aureole::sample_light(scene_, vertices_[i].p(), vertices_[i].facing(), samples.get1(first),
                                   samples.get2(first + 1), wavelengths(i));
    });
  }
  bool connect(int i, int k, Connection& out) {
    State& s = states_[i];
    const Vertex& vertex = vertices_[i];
    if (!has_connection(i, k) || (!is_in_medium(k) && scene_.lights().empty())) return false;
    SampleStream& samples = path(i).samples;
    const int first = std::exchange(s.dimension, s.dimension + 3);
    const std::uint32_t random = key(samples, first, Stream::connection);
    const bool found = is_in_medium(k) ? connect_to_emission<Unpolarised>(
                                             scene_, vertex, s.segment, s.density, samples.get1(first),
                                             samples.get2(first + 1), wavelengths(i), counts_, random, out)
                                       : connect_to_light(scene_, vertex, lights_[i], s.segment, s.density,
                                                          wavelengths(i), counts_, random, out);
    out.others_pass = true;
    return found;
  }
  void connected(int i, int, const Connection& c, bool open) {
    if (open) path(i).result.estimate += c.estimate();
    if (log_.follows(i)) log_connection(c, open);
  }
  std::uint32_t connection_key(int i) {
    return key(path(i).samples, states_[i].dimension, Stream::connection);
  }

  /// BSDF samples: lines of sight along sampled directions.
  void connected_all(const PathList& vertices) {
    for (int k = 0; k < bsdf_samples_; ++k) {
      for (const int i : vertices)
        if (begin_line(i)) lines_.driver.rays().add(i, lines_.steps.ray(i));
      lines_.driver.follow(RayTracer::Rays::incoherent);
    }
  }
  void see(int i, const Light& light, const SurfacePoint* point, const Vec3& d, const Spectrum& radiance) {
    if (is_black(radiance)) return;
    const PathDensity& sampled = states_[i].sampled;
    const float other =
        sampled.has_light_ratio()
            ? counts_.light * light_density(scene_, reference(i), light, point, d, wavelengths(i).time)
            : 0.f;
    path(i).result.estimate += sampled.met(radiance, other, wavelengths(i));
  }
  using Walk::emission;
  SegmentEmission emission(int i) {
    const PathDensity& sampled = states_[i].sampled;
    return {sampled.r_u, sampled.r_l * counts_.light, sampled.has_light_ratio() ? media_ : nullptr,
            reference(i)};
  }
  void see(int i, const Spectrum& light) {
    path(i).result.estimate += states_[i].sampled.seen(light) / wavelengths(i).pdf;
  }

  // Hooks of the walk:
  int edge_samples() const { return std::max(light_samples_, 1); }
  bool has_indirect_light() const { return false; }
  /// Continues behind a surface with a null component, with the probability of crossing it; the path ends
  /// otherwise.
  bool scatter(int i) {
    State& s = states_[i];
    const Vertex& vertex = vertices_[i];
    Scatter b;
    if (!vertex.is_passable() || sample(i, b) != Event::crossed) {
      path(i).result.alpha = 1;
      return false;
    }
    s.density.attenuate(b.transmittance);
    go_on(i, vertex, b.d, ends_segment(vertex));
    return true;
  }

private:
  bool has_connection(int i, int k) { return k < connection_count(i) && vertices_[i].is_smooth(); }
  /// Whether the k-th connection is one with a medium that emits.
  bool is_in_medium(int k) const { return media_ && k % 2 == 1; }
  LightReference reference(int i) { return {vertices_[i].p(), vertices_[i].facing()}; }
  Event sample(int i, Scatter& out) {
    SampleStream& samples = path(i).samples;
    const int first = std::exchange(states_[i].dimension, states_[i].dimension + 3);
    return vertices_[i].scatter(samples.get1(first), samples.get2(first + 1), out);
  }
  /// Samples a direction at the vertex by the BSDF; false where it has none.
  bool begin_line(int i) {
    State& s = states_[i];
    Scatter b;
    if (sample(i, b) != Event::surface) return false;
    s.sampled = s.density;
    s.sampled.extend(b.value, b.pdf * counts_.scatter, b.delta || !vertices_[i].is_smooth());
    RayState line = s.segment;
    vertices_[i].leave(b.d, scene_.has_media(), line);
    lines_.steps.begin(i, line, key(path(i).samples, s.dimension, Stream::line_of_sight));
    return true;
  }

  const EmittingMedia* media_;  ///< media whose emission next-event estimation samples, or null
  const int light_samples_, bsdf_samples_;
  const SampleCounts counts_;
  PerPath<LightSample> lights_;  ///< the light that the present connection leads to
  DrivenLines<DirectWalk> lines_;
};

class DirectIntegrator final : public Integrator {
public:
  explicit DirectIntegrator(const Properties& p)
      : Integrator(p),
        limits_(PathLimits::direct(p.get_bool("hide_emitters", false))),
        diffraction_(get_diffraction(p)) {
    const auto shading = p.get_int("shading_samples", 1, {0, 65536});
    if (p.has("shading_samples") && (p.has("emitter_samples") || p.has("bsdf_samples")))
      throw p.error("shading_samples",
                    "give either \"shading_samples\" or \"emitter_samples\" and \"bsdf_samples\"");
    light_samples_ = int(p.get_int("emitter_samples", shading, {0, 65536}));
    bsdf_samples_ = int(p.get_int("bsdf_samples", shading, {0, 65536}));
    if (light_samples_ + bsdf_samples_ == 0) throw p.error("bsdf_samples", "at least one sample is needed");
  }

  bool shows_light() const override { return true; }
  ReceiverRays receiver_rays() const override { return ReceiverRays::straight; }
  bool rays_go_behind() const override { return true; }
  bool shows_emitters() const override { return !limits_.hide_emitters; }
  SceneNeeds needs() const override { return {diffraction_, true}; }
  Leaves leaves() const override { return leaves_splats(diffraction_) ? Leaves::both : Leaves::pixel; }
  void require_scene(const Scene& scene) const override { require_no_glowing_media(scene, *this); }
  std::vector<std::string> scene_notes(const Scene& scene) const override { return medium_notes(scene); }

  void trace(const Scene& scene, std::span<Path> paths, std::vector<Splat>& splats,
             const BatchLog& log) const override {
    for (Path& p : paths) p.result = {};
    const Arena::Frame frame;
    const WalkInput in{scene, limits_, paths, log, frame.arena()};
    DirectWalk walk(in, light_samples_, bsdf_samples_);
    follow_from_start(in, walk);
    see_diffracted_light(in, splats);
  }

private:
  PathLimits limits_;
  int light_samples_, bsdf_samples_;
  std::optional<DiffractionSettings> diffraction_;
};

AUREOLE_PLUGIN(
    DirectIntegrator, "integrator", "direct",
    PluginDoc{
        "Direct illumination: light that surfaces scatter once, by any number of light and BSDF samples combined by "
        "spectral multiple importance sampling. Media absorb and emit: what they scatter is lost. Their emission is "
        "seen directly and lights surfaces. With `diffraction`, lights shine on them, or into the sensor, around one edge, too.",
        "Veach 1997, chapter 9",
        with_diffraction_parameters(
            {{"shading_samples", "integer", "", "1", "number of each of the two kinds of samples"},
             {"emitter_samples", "integer", "", "shading_samples",
              "samples of lights; of light around edges at least one"},
             {"bsdf_samples", "integer", "", "shading_samples", "samples of the BSDF"},
             {"hide_emitters", "boolean", "", "false", "camera rays pass through emitters"}}),
        {R"(<integrator type="direct"><integer name="emitter_samples" value="2"/><integer name="bsdf_samples" value="1"/>
    <boolean name="hide_emitters" value="true"/></integrator>)",
         R"(<integrator type="direct"><integer name="shading_samples" value="4"/></integrator>)",
         R"(<integrator type="direct"><boolean name="diffraction" value="true"/><string name="diffraction_model" value="beams"/><string name="beam_width" value="fresnel 2m"/></integrator>)"}});

}  // namespace
}  // namespace aureole
