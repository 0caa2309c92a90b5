// SPDX-License-Identifier: Apache-2.0
// Unidirectional spectral path tracer: a walk from the sensor, with next-event estimation at every vertex and, in media, from points
// along the ray that are sampled about a light.
#include <optional>

#include "aureole/integrator/diffraction_parameters.h"
#include "aureole/plugin/registry.h"
#include "aureole/transport/segment.h"
#include "aureole/transport/sight.h"
#include "aureole/transport/walk.h"

namespace aureole {
namespace {

/// Further state of a path in scenes of `Space::any`.
struct PathInSpace {
  /// At a vertex in a medium: the pdf of sampling its position about a light, relative to the hero's pdf of the walk.
  Spectrum r_equiangular;
  Spectrum emission_share{1.f};          ///< `EmissionSearch::share`
  PathDensity line_start;                ///< where the line of sight of `see_emission` has begun
  std::optional<Equiangular> positions;  ///< along the present ray, sampled about a light
};
struct PathInEmptySpace {};

template <Space kPathSpace>
struct PathKind {
  static constexpr Space kSpace = kPathSpace;
  static constexpr bool kEmerges = true;
  using Density = PathDensity;
  using State = std::conditional_t<kSpace == Space::any, PathInSpace, PathInEmptySpace>;
  using Vertices = PerPath<BasicVertex<kSpace>>;
};

template <Space kSpace>
class PathWalk : public Walk<PathWalk<kSpace>, PathKind<kSpace>> {
  using Base = Walk<PathWalk<kSpace>, PathKind<kSpace>>;
  using Base::has_media, Base::limits_, Base::log_, Base::scene_, Base::states_, Base::vertices_;
  using typename Base::State, typename Base::Vertex;
  static constexpr bool kAny = kSpace == Space::any;

public:
  using Base::path;

  explicit PathWalk(const WalkInput& in)
      : Base(in),
        media_(kAny ? connected_media(in.scene) : nullptr),
        // MIS weights along a ray do not know the choice of an edge that diffracts.
        samples_equiangular_(kAny && !in.scene.edges() && in.scene.lights().tree().can_be_connected()) {
    if (has_media()) sight_.emplace(in.scene, *this);
  }

  void start(int i) { this->begin_at_sensor(i); }

  // Next-event estimation: k = 0 a light, k = 1 a medium that emits.
  int connection_count(int) const { return media_ ? 2 : 1; }
  [[gnu::always_inline]] bool connect(int i, int k, Connection& out) {
    if constexpr (kAny)
      if (k == 1) return connect_to_emission(i, out);
    const State& s = states_[i];
    const Vertex& vertex = vertices_[i];
    const Spectrum* r_equiangular = nullptr;
    if constexpr (kAny)
      if (!vertex.is_surface()) {
        if (!scene_.lights_reach(*s.flight.medium)) return false;
        r_equiangular = &s.r_equiangular;
      }
    if (s.last || !vertex.is_smooth() || scene_.lights().empty()) return false;
    Path& p = path(i);
    return connect_to_light(scene_, vertex, s.flight, s.density,
                            scene_.lights().is_single() ? 0.f : get(p.samples, s.vertex, Choice::light),
                            get(s.pairs, Pair::connection), p.wavelengths, {},
                            has_media() ? key(p.samples, s.vertex, Key::connection) : 0, out, r_equiangular);
  }
  void connected(int i, int, const Connection& c, bool open) {
    if (open) path(i).result.estimate += c.light;
    if (log_.follows(i)) this->log_connection(c, open);
  }

  // Hooks of the walk:
  void emission(int i, const Light& light, const SurfacePoint* point, const Spectrum& radiance) {
    const State& s = states_[i];
    if (is_black(radiance)) return;
    if constexpr (kAny)
      if (s.emission_counted) return;
    Path& p = path(i);
    const Spectrum estimate =
        s.density.has_light_ratio()
            ? s.density.met(radiance, light_density(scene_, s.from, light, point, s.flight.ray.d),
                            p.wavelengths)
            : s.density.contribution(radiance, p.wavelengths);
    p.result.estimate += estimate;
    if (log_.follows(i)) this->log_emission(i, point, estimate);
  }
  Spectrum* emission_in_media(int i) {
    return states_[i].emission_counted ? nullptr : &path(i).result.estimate;
  }
  EmissionSearch emission_search(int i) { return {media_, states_[i].from, states_[i].emission_share}; }
  void before_flight(int i, const RayTracer::Hit& hit) {
    see_emission(i, hit);
    states_[i].positions = connect_segment(i, hit ? hit.t : kInfinity);
  }
  void after_flight(int i, const Vec3& p, const Spectrum& chosen) {
    State& s = states_[i];
    s.r_equiangular =
        s.positions ? chosen * s.positions->pdf(dot(p - s.flight.ray.o, s.flight.ray.d)) : Spectrum(0.f);
  }
  void scattered(int i, const Scatter& b) {
    if constexpr (kAny) {
      State& s = states_[i];
      s.emission_share = 1.f;
      if (vertices_[i].is_surface()) return;
      const Spectrum walked = s.density.light_ratio;
      s.density.light_ratio += s.r_equiangular * (1 / b.pdf[0]);
      if (media_) s.emission_share = safe_divide(walked, s.density.light_ratio);
    }
  }
  bool may_end_at_event(int i) const {
    return !const_cast<PathWalk*>(this)->vertices_[i].is_surface() && !may_sample_equiangular(states_[i]);
  }

  // For the driver:
  void put_segments(BatchConnections* room) requires kAny { segments_ = room; }
  void finish_looking() requires kAny {
    if (!lines_.empty()) follow(scene_, *sight_, lines_, RayTracer::Rays::incoherent);
  }

  // For lines of sight:
  Glow glow(int i) const { return {.ratio = states_[i].line_start.ratio}; }
  void see(int i, const Spectrum& light) {
    Path& p = path(i);
    p.result.estimate += states_[i].line_start.beta.of(light) / p.wavelengths.pdf;
    if (log_.follows(i))
      log_({.kind = PathEvent::Kind::other, .estimate = light, .text = "seen through media"});
  }
  void see(int i, const Light&, const SurfacePoint*, const Vec3&, const Spectrum& radiance) {
    if (!is_black(radiance)) see(i, radiance * (1 / sum(states_[i].line_start.ratio)));
  }

private:
  // It makes another key of one.
  static constexpr std::uint32_t kOther = 0x2545f491u;

  bool connect_to_emission(int i, Connection& out) requires kAny {
    const State& s = states_[i];
    const Vertex& vertex = vertices_[i];
    if (s.last || !vertex.is_smooth()) return false;
    Path& p = path(i);
    // The random numbers are those of the connection with a light: the two estimates add up.
    return aureole::connect_to_emission(scene_, vertex, s.flight, s.density,
                                        get(p.samples, s.vertex, Choice::light),
                                        get(s.pairs, Pair::connection), p.wavelengths, {},
                                        key(p.samples, s.vertex, Key::connection) ^ kOther, out);
  }

  /// Emission of lights behind media where next-event estimation cannot find it (from the sensor, after a mirror): a walk would be scattered
  /// before it or not, while a line of sight takes the transmittance and has no such noise. It begins where the ray first comes into a
  /// medium. Only towards lights with a shape: a sky is about as bright as the in-scattered light of the fog before it, so that the walk's
  /// single choice between the two has less noise than their sum.
  void see_emission(int i, const RayTracer::Hit& hit) {
    State& s = states_[i];
    if (s.emission_counted || s.density.has_light_ratio() || (limits_.hide_emitters && s.depth == 0)) return;
    if (!scene_.may_meet_shining_shape(s.flight.ray)) return;
    s.emission_counted = true;
    s.line_start = s.density;
    sight_->begin(i, s.flight, 1.f, key(path(i).samples, s.vertex, Key::flight) ^ kOther);
    if (sight_->arrive(i, hit) == Event::crossed) lines_.add(i, sight_->ray(i));
  }

  /// Whether positions along the present ray in its medium may be sampled about lights.
  bool may_sample_equiangular(const State& s) const {
    constexpr int kLatest = 8;  // after more scattering events the radiance is nearly uniform
    return samples_equiangular_ && s.depth < kLatest && scene_.lights_reach(*s.flight.medium);
  }

  /// Connects a position along the ray, sampled about a light near it, wherever the walk itself will be scattered. Such positions are not
  /// connected with emission of media, whose MIS weights do not count this technique (`emission_share`).
  std::optional<Equiangular> connect_segment(int i, float t_max) {
    const State& s = states_[i];
    Path& p = path(i);
    if (!may_sample_equiangular(s) || !limits_.reaches(s.depth + 2) || s.in_media == limits_.max_scattering ||
        s.density.beta.is_black())
      return {};
    // The random numbers are those of the next vertex: the two estimates add up.
    const std::uint32_t random = key(p.samples, s.vertex + 1, Key::connection) ^ kOther;
    const auto positions =
        places_by_light(scene_, s.flight, t_max, p.wavelengths, KeyedRandom(random).next());
    if (!positions) return {};
    const float* pairs = p.samples.directions(s.vertex + 1);
    if (connect_along(scene_, s.flight, s.density, *positions, get(p.samples, s.vertex, Choice::distance),
                      get(p.samples, s.vertex + 1, Choice::light), get(pairs, Pair::connection),
                      p.wavelengths, random + 1, segments_->of_path[i]))
      segments_->rays.add(i, segments_->of_path[i].flight.ray);
    return positions;
  }

  const EmittingMedia* media_;      ///< that next-event estimation samples, or null
  const bool samples_equiangular_;  ///< in media
  BatchConnections* segments_ = nullptr;
  std::optional<SightSteps<PathWalk>> sight_;  ///< in scenes with media
  BatchRays lines_;                            ///< its rays
};

class PathIntegrator final : public Integrator {
public:
  explicit PathIntegrator(const Properties& p)
      : Integrator(p), limits_(p), diffraction_(get_diffraction(p)) {}

  SceneNeeds needs() const override { return {diffraction_}; }
  Leaves leaves() const override { return diffraction_ ? Leaves::both : Leaves::pixel; }
  void require_scene(const Scene& scene) const override { require_no_glowing_media(scene, *this); }
  bool shows_emitters() const override { return limits_.reaches(1) && !limits_.hide_emitters; }

  void trace(const Scene& scene, std::span<Path> paths, std::vector<Splat>& splats,
             const BatchLog& log) const override {
    for (Path& p : paths) p.result = {};
    if (!limits_.reaches(1)) return;
    const WalkInput in{scene, limits_, paths, log};
    if (space_of(scene) == Space::any)
      follow_from_sensor<PathWalk<Space::any>>(in);
    else
      follow_from_sensor<PathWalk<Space::empty>>(in);
    follow_edge_paths(in, 1, true, splats, [](const WalkInput& second, const auto& begin) {
      PathWalk<Space::any> walk(second);
      BatchRays rays;
      begin(walk, rays);
      follow(second.scene, walk, rays, RayTracer::Rays::incoherent);
    });
  }

private:
  template <class PathWalk>
  static void follow_from_sensor(const WalkInput& in) {
    PathWalk walk(in);
    BatchRays rays;
    for (size_t i = 0; i < in.paths.size(); ++i) {
      walk.start(int(i));
      rays.add(int(i), in.paths[i].ray);
    }
    follow(in.scene, walk, rays, RayTracer::Rays::coherent);
  }

  PathLimits limits_;
  std::optional<BeamWidth> diffraction_;
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
             {"rr_depth", "integer", "", "5",
              "Russian roulette begins after this many vertices, 1000 at most"},
             {"max_scattering", "integer", "", "-1",
              "paths that media scatter more often do not count: 1 is single scattering; -1: no limit"},
             {"hide_emitters", "boolean", "", "false",
              "camera rays pass through area emitters and see no environment"}}),
        {R"(<integrator type="path"><integer name="max_depth" value="8"/><integer name="rr_depth" value="5"/>
    <integer name="max_scattering" value="1"/><boolean name="hide_emitters" value="false"/></integrator>)",
         R"(<integrator type="path"><boolean name="diffraction" value="true"/><string name="beam_width" value="50 wavelengths"/></integrator>)"}});

}  // namespace
}  // namespace aureole
