// SPDX-License-Identifier: Apache-2.0
// Direct illumination only, with chosen numbers of light and BSDF samples.
#include "aureole/integrator/diffraction_parameters.h"
#include "aureole/plugin/registry.h"
#include "aureole/transport/edge_walk.h"
#include "aureole/transport/endpoints.h"
#include "aureole/transport/sight.h"

namespace aureole {
namespace {

/// The surfaces that the sensor's rays meet and pass, what lights and media that emit send there, and what is seen
/// along sampled directions. No way through a medium ends there: what media let pass is in no density.
class DirectSteps {
public:
  DirectSteps(const Scene& scene, const SampleCounts& counts, bool hide_emitters, std::span<Path> paths)
      : scene_(scene),
        media_(connected_media(scene)),
        counts_(counts),
        hide_emitters_(hide_emitters),
        paths_(paths) {
    for (size_t i = 0; i < paths.size(); ++i) {
      states_[i].flight.ray = paths[i].ray;
      find_surroundings(scene, nullptr, states_[i].flight);
    }
  }

  const Ray& ray(int path) const { return states_[path].flight.ray; }
  const Wavelengths& wavelengths(int path) const { return paths_[size_t(path)].wavelengths; }
  bool needs_march() const { return !scene_.has_binary_visibility(); }
  std::uint32_t connection_key(int i) const { return paths_[size_t(i)].samples.key(states_[i].dimension); }

  Event arrive(int i, const RayTracer::Hit& hit) {
    State& s = states_[i];
    Path& path = paths_[size_t(i)];
    // Media absorb and emit here, and scatter nothing back.
    if (s.flight.medium) {
      Glow glow;
      const Straight light =
          transmittance(*s.flight.medium, s.flight.ray, hit ? hit.t : kInfinity, path.wavelengths,
                        path.samples.key(s.dimension), s.flight.medium->emits() ? &glow : nullptr);
      if (!is_black(glow.seen)) path.result.estimate += s.density.beta.of(glow.seen) / path.wavelengths.pdf;
      s.density.attenuate(Weight(light.passed * light.roulette));
    }
    lend_to_edges(scene_, s.flight.ray, hit ? hit.t : kInfinity, LightWay::End::vertex, path.wavelengths,
                  path.samples.key(s.dimension), s.density);
    if (!hit) return escape(i);
    Vertex& vertex = vertices_.make(
        i, [&] { return Vertex(scene_, hit, s.flight, path.wavelengths, TransportMode::radiance); });
    if (s.flight.is_hidden(vertex.surface())) {
      s.dimension += 3;
      go_on(i, s.flight.ray.d);
      return Event::crossed;
    }
    if (const Light* light = vertex.light()) {
      if (hide_emitters_) {
        s.dimension += scene_.has_media() ? 3 : 0;  // the way behind has random numbers of its own
        go_on(i, s.flight.ray.d);
        return Event::crossed;
      }
      path.result.estimate += s.density.contribution(
          light->eval(vertex.point(), -s.flight.ray.d, path.wavelengths), path.wavelengths);
    }
    vertex.prepare(path.samples.key(s.dimension), s.flight);
    s.smooth = vertex.is_smooth();
    s.is_lit = false;
    return Event::surface;
  }

  void lose(int i) { paths_[size_t(i)].result.invalidate(); }

  int connection_count(int) const { return media_ ? 2 : 1; }
  bool connect(int i, int k, Connection& out) {
    if (k == 1) return connect_to_emission(i, out);
    State& s = states_[i];
    if (!s.smooth || scene_.lights().empty()) return false;
    SampleStream& samples = paths_[size_t(i)].samples;
    const int first = std::exchange(s.dimension, s.dimension + 3);
    const bool found =
        connect_to_light(scene_, vertices_[i], s.flight, s.density, samples.get1(first),
                         samples.get2(first + 1), wavelengths(i), counts_, samples.key(first), out);
    out.others_pass = true;
    return found;
  }

  bool connect_to_emission(int i, Connection& out) {
    State& s = states_[i];
    if (!s.smooth) return false;
    SampleStream& samples = paths_[size_t(i)].samples;
    const int first = std::exchange(s.dimension, s.dimension + 3);
    const bool found = aureole::connect_to_emission(scene_, vertices_[i], s.flight, s.density,
                                                    samples.get1(first), samples.get2(first + 1),
                                                    wavelengths(i), counts_, samples.key(first), out);
    out.others_pass = true;
    return found;
  }

  void end_connection(int i, int, const Connection& c, bool open) {
    if (open) paths_[size_t(i)].result.estimate += c.light;
    states_[i].is_lit |= open;
  }

  /// Adds the light of lamps that reaches the vertices around one edge, the mean of `samples` estimates.
  void connect_around_edges(const PathList& vertices, int samples) {
    for (const int i : vertices) {
      State& s = states_[i];
      if (!s.smooth) continue;
      Path& path = paths_[size_t(i)];
      EdgePaths edges(scene_, path.wavelengths, path.samples.key(s.dimension) ^ 0x2545f491u);
      const Vertex& vertex = vertices_[i];
      Spectrum light = 0.f;
      for (int k = 0; k < samples; ++k)
        light += edges.from_light(EdgePaths::at_vertex(vertex, s.flight),
                                  s.is_lit ? EdgePaths::Beside::direct : EdgePaths::Beside::nothing, 1,
                                  [&](const Vec3& d) { return EdgePaths::response(vertex, d); });
      path.result.estimate += s.density.contribution(light * (1 / float(samples)), path.wavelengths);
    }
  }

  /// Samples a direction at the vertex to look for lights along it; false where there is none.
  bool look(int i, SightSteps<DirectSteps>& sight) {
    State& s = states_[i];
    Scatter b;
    if (sample(i, b) != Event::surface) return false;
    s.found = s.density;
    s.found.extend(b.value, b.pdf * counts_.scatter, b.delta || !s.smooth);
    Flight line = s.flight;
    vertices_[i].leave(b.d, scene_.has_media(), line);
    sight.begin(i, line, 1.f, paths_[size_t(i)].samples.key(s.dimension));
    return true;
  }

  void see(int i, const Light& light, const SurfacePoint* point, const Vec3& d, const Spectrum& radiance) {
    if (is_black(radiance)) return;
    const State& s = states_[i];
    const LightReference from{vertices_[i].p(), vertices_[i].facing()};
    const float other =
        s.found.has_light_ratio() ? counts_.light * light_density(scene_, from, light, point, d) : 0.f;
    paths_[size_t(i)].result.estimate += s.found.met(radiance, other, wavelengths(i));
  }

  Glow glow(int i) {
    const State& s = states_[i];
    return {s.found.ratio,
            s.found.light_ratio * counts_.light,
            s.found.has_light_ratio() ? media_ : nullptr,
            {vertices_[i].p(), vertices_[i].facing()}};
  }
  void see(int i, const Spectrum& light) {
    paths_[size_t(i)].result.estimate += states_[i].found.beta.of(light) / wavelengths(i).pdf;
  }

  /// Continues behind a surface that lets some light pass, with the probability of passing.
  bool scatter(int i) {
    State& s = states_[i];
    Scatter b;
    if (!vertices_[i].surface().passable || sample(i, b) != Event::crossed) {
      paths_[size_t(i)].result.alpha = 1;
      return false;
    }
    s.density.attenuate(b.value);
    go_on(i, b.d);
    return true;
  }

private:
  struct State {
    Flight flight;
    PathDensity density;
    PathDensity found;  ///< with a sampled direction
    int dimension = 0;  ///< of the sampler, the next one
    bool smooth = false;
    bool is_lit = false;  ///< the vertex has light of a lamp that was asked
  };

  void go_on(int i, const Vec3& d) { vertices_[i].leave(d, scene_.has_media(), states_[i].flight); }

  Event sample(int i, Scatter& out) {
    SampleStream& samples = paths_[size_t(i)].samples;
    const int first = std::exchange(states_[i].dimension, states_[i].dimension + 3);
    return vertices_[i].scatter(samples.get1(first), samples.get2(first + 1), out);
  }

  Event escape(int i) {
    if (hide_emitters_ || scene_.infinite_emitters().empty()) return Event::escape;
    const State& s = states_[i];
    RadianceEstimate& result = paths_[size_t(i)].result;
    Spectrum sum = 0.f;
    for (const Light* light : scene_.infinite_emitters())
      sum += light->eval_escaped(s.flight.ray.d, wavelengths(i));
    result.estimate += s.density.contribution(sum, wavelengths(i));
    result.alpha = 1;
    return Event::escape;
  }

  const Scene& scene_;
  const EmittingMedia* media_;  ///< those that connections look for, or null
  const SampleCounts& counts_;
  const bool hide_emitters_;
  std::span<Path> paths_;
  State states_[kBatch];
  PerPath<Vertex> vertices_;
};

class DirectIntegrator final : public Integrator {
public:
  explicit DirectIntegrator(const Properties& p) : Integrator(p), diffraction_(get_diffraction(p)) {
    const auto shading = p.get_int("shading_samples", 1, {0, 65536});
    if (p.has("shading_samples") && (p.has("emitter_samples") || p.has("bsdf_samples")))
      throw p.error("shading_samples",
                    "give either \"shading_samples\" or \"emitter_samples\" and \"bsdf_samples\"");
    light_samples_ = int(p.get_int("emitter_samples", shading, {0, 65536}));
    bsdf_samples_ = int(p.get_int("bsdf_samples", shading, {0, 65536}));
    if (light_samples_ + bsdf_samples_ == 0) throw p.error("bsdf_samples", "at least one sample is needed");
    hide_emitters_ = p.get_bool("hide_emitters", false);
  }

  bool shows_emitters() const override { return !hide_emitters_; }
  SceneNeeds needs() const override { return {diffraction_}; }
  Leaves leaves() const override { return diffraction_ ? Leaves::both : Leaves::pixel; }
  void require_scene(const Scene& scene) const override { require_no_glowing_media(scene, *this); }

  void trace(const Scene& scene, std::span<Path> paths, std::vector<Splat>& splats,
             const BatchLog&) const override {
    const bool has_edges = scene.edges() && !scene.edges()->empty();
    const SampleCounts counts{float(light_samples_), float(bsdf_samples_)};
    DirectSteps steps(scene, counts, hide_emitters_, paths);
    SightSteps sight(scene, steps);
    BatchRays rays, lines;
    BatchConnections connections;
    for (size_t i = 0; i < paths.size(); ++i) {
      paths[i].result = {};
      rays.add(int(i), paths[i].ray);
    }
    for (auto kind = RayTracer::Rays::coherent; !rays.empty(); kind = RayTracer::Rays::incoherent) {
      const PathList vertices = arrive_all(scene, steps, rays, kind);
      for (int k = 0; k < light_samples_; ++k) connect_vertices(scene, steps, vertices, connections);
      if (has_edges) steps.connect_around_edges(vertices, std::max(light_samples_, 1));
      for (int k = 0; k < bsdf_samples_; ++k) {
        for (const int i : vertices)
          if (steps.look(i, sight)) lines.add(i, sight.ray(i));
        follow(scene, sight, lines, RayTracer::Rays::incoherent);
      }
      scatter_all(steps, vertices, rays);
    }
    if (!has_edges) return;
    for (size_t i = 0; i < paths.size(); ++i)
      if (const auto splat = light_seen_around_edge(scene, int(i), paths[i], hide_emitters_))
        splats.push_back(*splat);
  }

private:
  int light_samples_, bsdf_samples_;
  bool hide_emitters_;
  std::optional<BeamWidth> diffraction_;
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
         R"(<integrator type="direct"><boolean name="diffraction" value="true"/><string name="beam_width" value="fresnel 2m"/></integrator>)"}});

}  // namespace
}  // namespace aureole
