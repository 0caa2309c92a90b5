// SPDX-License-Identifier: Apache-2.0
// Walks of `bdpt` from the lights, and their connections with the sensor.
#pragma once

#include "aureole/integrator/bdpt/techniques.h"

namespace aureole::bdpt {

/// Further state of a light path.
template <class L>
struct LightState {
  SampleStream samples;
  Emission emission;
  LightSubpathDensity<L> arrived;        ///< throughput and pdfs at the present vertex
  const LightVertex<L>* kept = nullptr;  ///< the last vertex that may be connected
};

template <class Light>
struct LightKind {
  using L = Light;
  static constexpr Space kSpace = Space::any;
  static constexpr bool kScattersInMedia = true;
  static constexpr bool kEmerges = false;  // `BidirectionalPathTracer::require_scene` refuses such scenes
  using Density = LightSubpathDensity<L>;
  using State = LightState<L>;
  using Vertices = LightVertices<L>;
};

template <class L>
class LightWalk : public Walk<LightWalk<L>, LightKind<L>> {
  using Base = Walk<LightWalk<L>, LightKind<L>>;
  using Base::limits_, Base::log_, Base::scene_, Base::states_, Base::vertices_;
  using typename Base::State, typename Base::Scatter, typename Base::Vertex;

public:
  using Base::wavelengths;
  using typename Base::Connection;

  /// `streams`: how often `SampleStream::of_second_path` is applied to the random numbers of a sample.
  /// `earlier`: another walk to whose vertices this walk adds its own, or null.
  LightWalk(const WalkInput& in, const Techniques& techniques, std::vector<Splat>& splats, int streams = 1,
            const LightWalk* earlier = nullptr)
      : Base(in), techniques_(techniques), splats_(splats), film_(in.arena.allocate<Vec2>(in.paths.size())) {
    for (size_t i = 0; i < in.paths.size(); ++i) {
      State& s = states_[i];
      s.samples = in.paths[i].samples;
      for (int k = 0; k < streams; ++k) s.samples = s.samples.of_second_path();
      if (earlier) s.kept = earlier->last_vertex(int(i));
    }
  }

  /// The last vertex of a path that may be connected, from which `previous` leads to the others.
  const LightVertex<L>* last_vertex(int i) const { return states_[i].kept; }

  /// Begins a path at a light; false where it carries no light.
  bool start(int i) {
    State& s = states_[i];
    const auto emitted =
        this->begin_at_light(i, s.samples.get2(SampleStream::choice(0, int(Choice::light))), 1);
    if (!emitted) return false;
    const aureole::Light& light = *emitted->choice.light;
    s.emission = {emitted->choice, emitted->ray};
    // Other techniques sample the position on the light by solid angle at the first vertex; this cosine
    // converts the position's pdf from area.
    const float cosine = light.shape ? std::abs(dot(emitted->ray.ng, emitted->ray.d)) : 1.f;
    s.density.earlier = light.is_delta() ? 0.f : cosine / emitted->pdf;
    s.density.r_l = cosine / emitted->pdf;
    s.from.p = emitted->ray.p;
    return true;
  }

  /// Connects the vertex with the sensor.
  bool connect(int i, int, Connection& out) {
    State& s = states_[i];
    const Vertex& vertex = vertices_[i];
    if (!may_connect(i) || !techniques_.have(s.depth + 2, 1)) return false;
    const Vec2 lens = scene_.sensor().uses_lens() ? get(s.samples, s.vertex, Pair::connection) : Vec2{};
    return connect_to_sensor<L>(
        scene_, vertex, s.segment, s.arrived.beta, lens, limits_.hide_emitters, wavelengths(i),
        key(s.samples, s.vertex, Stream::connection), out, film_[i],
        [&](const auto& seen, const auto&, Spectrum& own, Spectrum& other) {
          const auto inverse = scene_.sensor().eval(vertex.p(), -seen.wo, seen.film, wavelengths(i).time);
          if (!inverse) return false;
          own = s.arrived.r_u;
          other = techniques_.others(inverse->pdf_across * vertex.density_across(seen.wo) *
                                     s.arrived.others(vertex.reverse_pdf(seen.wo)));
          return true;
        });
  }
  void connected(int i, int, const Connection& c, bool open) {
    if (open) splats_.push_back({i, film_[i], c.estimate()});
    if (log_.follows(i)) this->log_sensor(c, film_[i], open);
  }

  // Hooks of the walk:
  SampleStream& samples(int i) { return states_[i].samples; }
  const LightSubpathDensity<L>& vertex_density(int i) const { return states_[i].arrived; }
  /// Stores the pdfs of a vertex, which is kept for connections.
  void at_vertex(int i) {
    State& s = states_[i];
    LightVertex<L>& present = vertices_.present(i);
    const Vertex& vertex = present.vertex;
    s.arrived = s.density;
    float spread = length_squared(vertex.p() - s.from.p);
    if (s.depth == 0) {
      // The pdf of connecting to a shape is already per solid angle; the pdf of connecting to a point light
      // is not.
      spread = s.emission.connection_density(scene_, {vertex.p(), vertex.facing()}, wavelengths(i).time) *
               (s.emission.ray.delta_position ? spread : 1.f);
    }
    s.arrived.arrive(!vertex.is_surface(), vertex.density_across(s.segment.ray.d), spread);
    if (!may_connect(i)) return;
    present.density = s.arrived;
    present.edges = s.depth + 1, present.crossed = s.crossed, present.in_media = s.in_media;
    present.previous = s.kept, present.count = s.kept ? s.kept->count + 1 : 1;
    s.kept = &present;
  }
  void extend(int i, const Scatter& b) {
    State& s = states_[i];
    const Vertex& vertex = vertices_[i];
    s.density = s.arrived;
    s.density.scatter(b, vertex.reverse_pdf(b), vertex.density_across(b.d));
  }

private:
  /// Whether other techniques connect the present vertex.
  bool may_connect(int i) { return vertices_[i].is_smooth() && !this->diffraction(i).found_from_sensor; }

  const Techniques& techniques_;
  std::vector<Splat>& splats_;
  Vec2* const film_;  ///< position on the film to which a connection contributes
};

}  // namespace aureole::bdpt
