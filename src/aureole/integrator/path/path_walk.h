// SPDX-License-Identifier: Apache-2.0
// The walk of `path`: from the sensor, with next-event estimation at every vertex and, in media, from
// positions along the ray that are sampled about a light.
#pragma once

#include <optional>

#include "aureole/transport/equiangular_connection.h"
#include "aureole/transport/line_of_sight.h"
#include "aureole/transport/walk.h"

namespace aureole {

/// Further state of a path in scenes of `Space::any`.
template <class L>
struct PathInSpace {
  /// At a vertex in a medium: the pdf of sampling its position by equiangular sampling, relative to the
  /// hero's pdf of the walk.
  Spectrum r_equiangular;
  Spectrum emission_share{1.f};  ///< fraction `EmissionSampling::share` of the path
  /// density of the path at the origin of the line of sight
  BasicPathDensity<L, PathStart::sensor> line_start;
  std::optional<Equiangular> positions;  ///< equiangular sampling along the present ray
};
template <Space kPathSpace, class Light = Unpolarised>
struct PathKind {
  using L = Light;
  static constexpr Space kSpace = kPathSpace;
  static constexpr bool kEmerges = true, kScattersInMedia = true;
  using Density = BasicPathDensity<L, PathStart::sensor>;
  struct State {};
  using Vertices = PerPath<BasicVertex<kSpace, L>>;
};

template <Space kSpace, class L = Unpolarised>
class PathWalk : public Walk<PathWalk<kSpace, L>, PathKind<kSpace, L>> {
  using Base = Walk<PathWalk<kSpace, L>, PathKind<kSpace, L>>;
  using Base::has_media, Base::limits_, Base::log_, Base::scene_, Base::states_, Base::vertices_;
  using typename Base::State, typename Base::Scatter, typename Base::Vertex;
  static constexpr bool kAny = kSpace == Space::any;

public:
  static constexpr bool kDefersDiffraction = true;
  using Base::path, Base::emission;
  using typename Base::Connection;

  explicit PathWalk(const WalkInput& in)
      : Base(in),
        media_(kAny ? connected_media(in.scene) : nullptr),
        // Equiangular sampling is off in scenes with edges that diffract, since its MIS weights do not
        // include the choice of an edge.
        samples_equiangular_(kAny && !in.scene.diffraction() && in.scene.lights().tree().can_be_connected()),
        in_space_(in.arena.make<PathInSpace<L>>(kAny ? in.paths.size() : 0).data()),
        lights_(in.arena, in.paths.size()) {
    if (!has_media()) return;
    lines_.emplace(in, *this);
    if (samples_equiangular_) along_rays_.emplace(in.arena, in.paths.size());
  }

  bool start(int i) {
    this->begin_at_sensor(i);
    // Light sampling at a receiver finds no emission of media.
    if constexpr (kAny) in_space_[i].emission_share = path(i).receiver ? 0.f : 1.f;
    return true;
  }

  // Next-event estimation: k = 0 a light, k = 1 a medium that emits.
  int connection_count(int) const { return media_ ? 2 : 1; }
  void choose(int i, int k) {
    if (kAny && k == 1) return;
    lights_.make(i, [&] { return this->sample_light(i); });
  }
  [[gnu::always_inline]] bool connect(int i, int k, Connection& out) {
    if constexpr (kAny)
      if (k == 1) return connect_to_emission(i, out);
    const State& s = states_[i];
    const Vertex& vertex = vertices_[i];
    const Spectrum* r_equiangular = nullptr;
    if constexpr (kAny)
      if (!vertex.is_surface()) r_equiangular = &in_space_[i].r_equiangular;
    Path& p = path(i);
    if (!connect_to_light(scene_, vertex, lights_[i], s.segment, s.density, p.wavelengths, {},
                          has_media() ? key(p.samples, s.vertex, Stream::connection) : 0, out, r_equiangular))
      return false;
    out.others_go_behind = true;
    return true;
  }
  void connected(int i, int k, const Connection& c, bool open) {
    if (open) path(i).result.estimate += c.estimate();
    if (log_.follows(i)) this->log_connection(c, open, 0, k < 0);
  }

  // Hooks of the walk:
  Spectrum* emission_in_media(int i) {
    return states_[i].emission_counted ? nullptr : &path(i).result.estimate;
  }
  EmissionSampling emission_sampling(int i) { return {media_, states_[i].from, in_space_[i].emission_share}; }
  void before_distance(int i, const RayTracer::Hit& hit) {
    begin_line(i, hit);
    in_space_[i].positions = connect_segment(i, hit ? hit.t : kInfinity);
  }
  void after_distance(int i, const Vec3& p, const Spectrum& chosen) {
    PathInSpace<L>& rare = in_space_[i];
    const Segment& segment = states_[i].segment;
    rare.r_equiangular = rare.positions
                             ? chosen * rare.positions->pdf(dot(p - segment.from_surface().o, segment.ray.d))
                             : Spectrum(0.f);
  }
  void scattered(int i, const Scatter& b) {
    if constexpr (kAny) {
      PathInSpace<L>& rare = in_space_[i];
      rare.emission_share = 1.f;
      if (vertices_[i].is_surface()) return;
      Spectrum& r_l = states_[i].density.r_l;
      const Spectrum walked = r_l;
      r_l += rare.r_equiangular * (1 / b.pdf[0]);
      if (media_) rare.emission_share = safe_divide(walked, r_l);
    }
  }
  bool may_cut_ray(int i) const { return !vertices_[i].is_surface() && !may_sample_equiangular(states_[i]); }

  // Functions that the driver calls:
  BatchConnections<Connection>* along_rays() requires kAny { return along_rays_ ? &*along_rays_ : nullptr; }
  void finish_lines() requires kAny {
    if (lines_) lines_->driver.follow(RayTracer::Rays::incoherent);
  }

  // Functions that lines of sight call:
  SegmentEmission emission(int i) const { return {.r_u = in_space_[i].line_start.r_u}; }
  void see(int i, const Spectrum& light) { add_seen(i, nullptr, {}, light); }
  void see(int i, const Light&, const SurfacePoint* point, const Vec3& d, const Spectrum& radiance) {
    if (!is_black(radiance)) add_seen(i, point, d, radiance * (1 / sum(in_space_[i].line_start.r_u)));
  }

private:
  /// Adds emission along a line of sight: of a light at `point` or along `d`, or of media.
  void add_seen(int i, const SurfacePoint* point, const Vec3& d, const Spectrum& light) {
    Path& p = path(i);
    const Spectrum estimate = in_space_[i].line_start.seen(light) / p.wavelengths.pdf;
    p.result.estimate += estimate;
    if (log_.follows(i))
      log_({.kind = PathEvent::Kind::other,
            .p = point ? point->p : Vec3{},
            .d = d,
            .infinite = !point,
            .estimate = estimate,
            .text = "seen through media"});
  }

  bool connect_to_emission(int i, Connection& out) requires kAny {
    const State& s = states_[i];
    const Vertex& vertex = vertices_[i];
    if (s.last || !vertex.is_smooth()) return false;
    Path& p = path(i);
    // Both connections use the same random numbers, since their estimates are summed.
    return aureole::connect_to_emission(
        scene_, vertex, s.segment, s.density, get(p.samples, s.vertex, Choice::light),
        get(s.pairs, Pair::connection), p.wavelengths, {}, key(p.samples, s.vertex, Stream::emission), out);
  }

  /// Emission of lights behind media where next-event estimation cannot find it (from the sensor, after a
  /// mirror): a walk that either reaches the light or is scattered before it has noise, which a line of sight
  /// by its transmittance has not. It begins where the ray first comes into a medium. Only towards lights
  /// with a shape: a sky is about as bright as the in-scattered light of the fog before it, so that the
  /// walk's single choice between the two has less noise than their sum.
  void begin_line(int i, const RayTracer::Hit& hit) {
    State& s = states_[i];
    if (s.emission_counted || s.density.has_light_ratio() || (limits_.hide_emitters && s.depth == 0)) return;
    if (!scene_.may_meet_shining_shape(s.segment.ray)) return;
    s.emission_counted = true;
    in_space_[i].line_start = s.density;
    LinesOfSight<PathWalk>& steps = lines_->steps;
    steps.begin(i, s.segment, key(path(i).samples, s.vertex, Stream::line_of_sight));
    if (steps.locate(i, hit) == Event::crossed) lines_->driver.rays().add(i, steps.ray(i));
  }

  /// Whether positions along the present ray in its medium may be sampled about lights.
  bool may_sample_equiangular(const State& s) const {
    constexpr int kLatest = 8;  // scattering events after which the radiance is nearly uniform
    return samples_equiangular_ && s.depth < kLatest && scene_.lights_reach(*s.segment.medium);
  }

  /// Connects a position along the ray, sampled about a light near it, independently of where the walk will
  /// be scattered. Such positions are not connected with emission of media, whose MIS weights do not include
  /// this technique (`emission_share`).
  std::optional<Equiangular> connect_segment(int i, float t_max) {
    const State& s = states_[i];
    Path& p = path(i);
    if (!may_sample_equiangular(s) || !this->reaches(i, 2) || s.in_media == limits_.max_scattering ||
        !s.density.has_light())
      return {};
    // The random numbers of the next vertex serve for this position as well, since both estimates are summed.
    const std::uint32_t random = key(p.samples, s.vertex, Stream::equiangular);
    const auto positions =
        equiangular_positions(scene_, s.segment, t_max, p.wavelengths, KeyedRandom(random).next());
    if (!positions) return {};
    const float* pairs = p.samples.directions(s.vertex + 1);
    if (connect_along(scene_, s.segment, s.density, *positions, get(p.samples, s.vertex, Choice::distance),
                      get(p.samples, s.vertex + 1, Choice::light), get(pairs, Pair::connection),
                      p.wavelengths, key(p.samples, s.vertex, Stream::equiangular_connection),
                      along_rays_->of_path[i])) {
      along_rays_->of_path[i].crossings_left = this->crossings_left(i, -1);
      along_rays_->of_path[i].ray.time = p.wavelengths.time;
      along_rays_->rays.add(i, along_rays_->of_path[i].ray);
    }
    return positions;
  }

  const EmittingMedia* media_;      ///< media whose emission next-event estimation samples, or null
  const bool samples_equiangular_;  ///< whether equiangular sampling is used in media
  PathInSpace<L>* const in_space_;  ///< of each path
  PerPath<LightSample> lights_;     ///< the light that the present connection leads to
  std::optional<BatchConnections<Connection>>
      along_rays_;                              ///< of positions along the rays, in scenes with media
  std::optional<DrivenLines<PathWalk>> lines_;  ///< lines of sight, in scenes with media
};

}  // namespace aureole
