// SPDX-License-Identifier: Apache-2.0
// Walks of `bdpt` from the lights, and their connections with the sensor.
#pragma once

#include "aureole/integrator/bdpt/techniques.h"

namespace aureole::bdpt {

/// Further state of a light path.
struct LightState {
  SampleStream samples;
  Emission emission;
  LightSubpathDensity arrived;        ///< throughput and pdfs at the present vertex
  const LightVertex* kept = nullptr;  ///< the last vertex that may be connected
};

struct LightKind {
  static constexpr Space kSpace = Space::any;
  static constexpr bool kEmerges = false;  // `BidirectionalPathTracer::require_scene` refuses such scenes
  using Density = LightSubpathDensity;
  using State = LightState;
  using Vertices = LightVertices;
};

class LightWalk : public Walk<LightWalk, LightKind> {
public:
  /// `streams`: the random numbers are those of the so-manieth second stream of each sample. `earlier`: another walk, to whose vertices those of
  /// this one are added, or null.
  LightWalk(const WalkInput& in, const Techniques& techniques, std::vector<Splat>& splats, int streams = 1,
            const LightWalk* earlier = nullptr)
      : Walk(in), techniques_(techniques), splats_(splats) {
    for (size_t i = 0; i < in.paths.size(); ++i) {
      State& s = states_[i];
      s.samples = in.paths[i].samples;
      for (int k = 0; k < streams; ++k) s.samples = s.samples.of_second_path();
      if (earlier) s.kept = earlier->last_vertex(int(i));
    }
  }

  /// The last vertex of a path that may be connected, from which `previous` leads to the others.
  const LightVertex* last_vertex(int i) const { return states_[i].kept; }

  /// Begins a path at a light; false where it carries no light.
  bool start(int i) {
    State& s = states_[i];
    const auto emitted = begin_at_light(i, s.samples.get2(SampleStream::choice(0, int(Choice::light))), 1);
    if (!emitted) return false;
    const Light& light = *emitted->choice.light;
    s.emission = {emitted->choice, emitted->ray};
    // Other techniques find the position on the light by its solid angle as seen from the first vertex: one vertex has the cosine of this.
    const float cosine = light.shape ? std::abs(dot(emitted->ray.ng, emitted->ray.d)) : 1.f;
    s.density.earlier = light.is_delta() ? 0.f : cosine / emitted->pdf;
    s.density.light_ratio = cosine / emitted->pdf;
    s.from.p = emitted->ray.p;
    return true;
  }

  /// With the sensor.
  bool connect(int i, int, Connection& out) {
    State& s = states_[i];
    const Vertex& vertex = vertices_[i];
    if (!may_connect(i) || !techniques_.have(s.depth + 2, 1)) return false;
    // Rays of the sensor pass through the surfaces of lights.
    if (limits_.hide_emitters && vertex.light()) return false;
    const Vec2 lens = scene_.sensor().uses_lens() ? get(s.samples, s.vertex, Pair::connection) : Vec2{};
    const auto seen = scene_.sensor().sample_direct(vertex.p(), lens);
    if (!seen || !(seen->importance > 0)) return false;
    if (!vertex.is_surface() && !scene_.may_see(*s.flight.medium, seen->p)) return false;
    const auto inverse = scene_.sensor().eval(vertex.p(), -seen->wo, seen->film);
    Response response;
    if (!inverse || !vertex.respond(seen->wo, response)) return false;
    const Spectrum other = techniques_.others(inverse->pdf_across * vertex.density_across(seen->wo) *
                                              s.arrived.others(vertex.reverse_pdf(seen->wo)));
    out.set(vertex.anchor(), seen->wo, Anchor::in_space(seen->p));
    out.through_emitters = limits_.hide_emitters;
    out.light = response.value.after(s.arrived.beta).of(Spectrum(seen->importance));
    weigh(scene_, s.arrived.ratio, other, wavelengths(i), out);
    if (scene_.has_media())
      out.begin_in(vertex.surroundings(seen->wo, s.flight), key(s.samples, s.vertex, Key::connection));
    film_[i] = seen->film;
    return true;
  }
  void connected(int i, int, const Connection& c, bool open) {
    if (open) splats_.push_back({i, film_[i], c.light});
    if (log_.follows(i)) log_sensor(c, film_[i], open);
  }

  // Hooks of the walk:
  SampleStream& samples(int i) { return states_[i].samples; }
  const LightSubpathDensity& vertex_density(int i) const { return states_[i].arrived; }
  /// The pdfs of a vertex, which is kept for connections.
  void at_vertex(int i) {
    State& s = states_[i];
    LightVertex& present = vertices_.present(i);
    const Vertex& vertex = present.vertex;
    s.arrived = s.density;
    float spread = length_squared(vertex.p() - s.from.p);
    if (s.depth == 0) {
      // The pdf of the connection is per solid angle already, but not that with a point.
      spread = s.emission.connection_density(scene_, {vertex.p(), vertex.facing()}) *
               (s.emission.ray.delta_position ? spread : 1.f);
    }
    s.arrived.arrive(!vertex.is_surface(), vertex.density_across(s.flight.ray.d), spread);
    if (!may_connect(i)) return;
    present.density = s.arrived;
    present.edges = s.depth + 1, present.in_media = s.in_media;
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
  bool may_connect(int i) { return vertices_[i].is_smooth() && !states_[i].after_edge.found_from_sensor; }

  const Techniques& techniques_;
  std::vector<Splat>& splats_;
  Vec2 film_[kBatch];  ///< where the light of a connection falls
};

}  // namespace aureole::bdpt
