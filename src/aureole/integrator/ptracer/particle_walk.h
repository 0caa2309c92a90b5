// SPDX-License-Identifier: Apache-2.0
// The walk of `ptracer`: paths from the lights, connected with the sensor at every vertex.
#pragma once

#include <algorithm>

#include "aureole/math/warp.h"
#include "aureole/transport/walk.h"

namespace aureole {

template <class Light = Unpolarised>
struct ParticleKind {
  using L = Light;
  static constexpr Space kSpace = Space::any;
  static constexpr bool kEmerges = true, kScattersInMedia = true;
  using Density = BasicPathDensity<L, PathStart::emitter>;
  struct State {};
  using Vertices = PerPath<BasicVertex<Space::any, L>>;
};

/// Paths from the lights.
template <class L = Unpolarised>
class ParticleWalk : public Walk<ParticleWalk<L>, ParticleKind<L>> {
  using Base = Walk<ParticleWalk<L>, ParticleKind<L>>;
  using Base::limits_, Base::log_, Base::scene_, Base::states_, Base::vertices_;
  using typename Base::State, typename Base::Scatter, typename Base::Vertex;

public:
  using Base::path, Base::connection_key;
  using typename Base::Connection;

  ParticleWalk(const WalkInput& in, std::vector<Splat>& splats)
      : Base(in),
        splats_(splats),
        counts_crossings_(in.scene.sensor().counts_crossings()),
        counts_beams_(counts_crossings_ && in.limits.reaches(1) && !in.limits.hide_emitters),
        film_(in.arena.allocate<Vec2>(in.paths.size())) {}

  /// Whether paths of one segment, straight from a light to the sensor, count.
  bool counts_beams() const { return counts_beams_; }

  /// Begins a path at a light, or in a medium that emits; false where it carries no light, or has no vertex.
  bool start(int i) {
    Path& p = path(i);
    Vec2 u = p.samples.get2(SampleStream::choice(0, int(Choice::light)));
    const EmittingMedia* media = scene_.emitting_media();
    const float share = media ? float(media->power() / (media->power() + scene_.lights().power())) : 0.f;
    if (media && u.x < share) return start_in_medium(i, *media, u.x / share, share) && limits_.reaches(2);
    if (share > 0) u.x = std::min((u.x - share) / (1 - share), 0x1.fffffep-1f);
    const auto emitted = this->begin_at_light(i, u, 1 - share);
    if (!emitted) return false;
    // A beam of one direction, which no connection finds. A beam from infinity is found by the connections of
    // the receivers.
    if (counts_beams_ && emitted->ray.delta_direction && !emitted->choice.light->is_infinite())
      cross_receivers(i, RayOrigin::of(emitted->ray), emitted->ray.d, [&] { return states_[i].segment; });
    return limits_.reaches(2);
  }

  bool connect(int i, int, Connection& out) {
    State& s = states_[i];
    Path& p = path(i);
    const Vec2 lens = scene_.sensor().uses_lens() ? get(p.samples, s.vertex, Pair::connection) : Vec2{};
    return connect_to_sensor<L>(scene_, vertices_[i], s.segment, s.density.beta, lens, limits_.hide_emitters,
                                p.wavelengths,
                                scene_.has_media() ? key(p.samples, s.vertex, Stream::connection) : 0, out,
                                film_[i], [&](const auto&, const auto&, Spectrum& own, Spectrum& other) {
                                  own = s.density.r_u, other = 0.f;  // no other technique finds such a path
                                  return true;
                                });
  }
  void connected(int i, int, const Connection& c, bool open) {
    if (open) splat(i, film_[i], c.estimate());
    if (log_.follows(i)) this->log_sensor(c, film_[i], open);
  }
  void splat(int i, Vec2 film, const Spectrum& estimate) { splats_.push_back({i, film, estimate}); }

  // Hooks of the walk:
  bool follows_last(int) const { return counts_crossings_; }
  void scattered(int i, const Scatter& b) {
    if (!counts_crossings_ || !b.delta) return;
    const Vertex& vertex = vertices_[i];
    cross_receivers(i, vertex.origin(), b.d, [&] { return vertex.leaving(b.d, states_[i].segment); });
  }

private:
  bool start_in_medium(int i, const EmittingMedia& media, float u, float share) {
    Path& p = path(i);
    State& s = states_[i];
    KeyedRandom third(key(p.samples, 0, Stream::emitting_medium));
    const EmittingMedia::Place place =
        media.sample_by_power(std::min(u, 0x1.fffffep-1f), get(p.samples, 0, Pair::connection), third.next());
    const Vec3 d = square_to_uniform_sphere(get(p.samples, 0, Pair::scatter));
    s.segment.ray = {place.p, d, kInfinity};
    s.segment.begin();
    find_interiors(scene_, s.segment);
    if (s.segment.medium != place.medium) return false;
    if (!(place.medium->majorants().bound_at(place.p) > 0)) return false;
    MediumCoefficients at;
    place.medium->eval(place.p, -d, p.wavelengths, at);
    const float pdf = share * place.pdf * uniform_sphere_pdf();
    if (is_black(at.emission) || !(pdf > 0)) return false;
    s.density.beta = L::emitted(at.emission);
    s.density.survive(pdf);
    s.first_throughput = s.density.hero_symmetric_throughput();
    if (log_.follows(i))
      log_({.kind = PathEvent::Kind::start, .p = place.p, .d = d, .in_medium = place.medium});
    return true;
  }

  /// Light that a mirror or a beam has sent along `d`, where its ray crosses the sensor's receivers. No
  /// connection finds it.
  template <class Start>
  void cross_receivers(int i, const RayOrigin& from, const Vec3& d, const Start& start) {
    const State& s = states_[i];
    Path& p = path(i);
    scene_.sensor().for_crossings(from.spawn(d), [&](const SensorCrossing& crossing) {
      Connection c;
      c.set(from, d, RayOrigin::in_space(crossing.p));
      c.through_emitters = limits_.hide_emitters;
      c.near = typename L::Weight(Spectrum(crossing.importance));
      c.far = s.density.beta;
      if (scene_.has_media()) c.begin_in(start(), key(p.samples, s.vertex, Stream::connection));
      c.weigh(scene_.has_media(), s.density.r_u, 0.f, p.wavelengths);
      const SegmentChain& chain = this->diffraction(i).chain;
      const bool open =
          arrives(scene_, c, p.wavelengths, connection_key(i), chain.is_linked() ? &chain : nullptr);
      if (open) splat(i, crossing.film, c.estimate());
      if (log_.follows(i)) this->log_sensor(c, crossing.film, open);
    });
  }

  std::vector<Splat>& splats_;
  const bool counts_crossings_, counts_beams_;
  Vec2* const film_;  ///< position on the film to which a connection contributes
};

}  // namespace aureole
