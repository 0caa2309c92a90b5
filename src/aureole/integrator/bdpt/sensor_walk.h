// SPDX-License-Identifier: Apache-2.0
// Walks of `bdpt` from the sensor, with their connections to lights and to the light paths.
#pragma once

#include <algorithm>

#include "aureole/core/random.h"
#include "aureole/integrator/bdpt/light_walk.h"

namespace aureole::bdpt {

/// Further state of a path from the sensor.
template <class L>
struct SensorState {
  SensorSubpathDensity<L> arrived;        ///< throughput and pdfs at the present vertex
  const LightVertex<L>* light = nullptr;  ///< the last vertex of the light path that it is connected with
  const LightVertex<L>* present_light;    ///< the vertex of the present connection
};

template <class Light>
struct SensorKind {
  using L = Light;
  static constexpr Space kSpace = Space::any;
  static constexpr bool kScattersInMedia = true;
  static constexpr bool kEmerges = false;  // `BidirectionalPathTracer::require_scene` refuses such scenes
  using Density = SensorSubpathDensity<L>;
  using State = SensorState<L>;
  using Vertices = PerPath<BasicVertex<Space::any, L>>;
};

template <class L>
class SensorWalk : public Walk<SensorWalk<L>, SensorKind<L>> {
  using Base = Walk<SensorWalk<L>, SensorKind<L>>;
  using Base::limits_, Base::log_, Base::scene_, Base::states_, Base::vertices_;
  using typename Base::State, typename Base::Scatter, typename Base::Vertex;

public:
  using Base::path, Base::wavelengths;
  using typename Base::Connection;

  /// `light`: light paths to whose vertices each path is connected, or null.
  SensorWalk(const WalkInput& in, const Techniques& techniques, const LightWalk<L>* light)
      : Base(in), techniques_(techniques), lights_(in.arena, in.paths.size()) {
    for (size_t i = 0; light && i < in.paths.size(); ++i) states_[i].light = light->last_vertex(int(i));
  }

  /// Begins a path with the ray of the sensor.
  bool start(int i) {
    this->begin_at_sensor(i);
    states_[i].density.r_l = 1.f;  // `at_vertex` sets the pdf of the first vertex from the sensor
    return true;
  }
  const LightVertex<L>* last_light_vertex(int i) const { return states_[i].light; }

  // Connections: k = 0 a light, k = 1, 2, ... the vertices of the light path, from its last one on.
  int connection_count(int i) {
    const State& s = states_[i];
    return s.light && is_connectable(i) ? 1 + s.light->count : 1;
  }
  void choose(int i, int k) {
    if (k > 0) return;
    lights_.make(i, [&]() -> LightSample {
      if (!techniques_.have(1, states_[i].depth + 2)) return {};
      return this->sample_light(i);
    });
  }
  bool connect(int i, int k, Connection& out) {
    if (k == 0) return connect_with_light(i, out);
    State& s = states_[i];
    s.present_light = k == 1 ? s.light : s.present_light->previous;
    return connect_with_vertex(i, *s.present_light, out);
  }
  void connected(int i, int k, const Connection& c, bool open) {
    if (open) path(i).result.estimate += c.estimate();
    if (log_.follows(i)) this->log_connection(c, open, k > 0 ? states_[i].present_light->edges : 0);
  }
  /// Whether paths that connect the present vertex with the light path's vertex `end` count.
  bool may_connect(int i, const LightVertex<L>& end) const {
    const State& s = states_[i];
    return this->reaches(i, 2 + end.edges + end.crossed) && techniques_.have(end.edges + 1, s.depth + 2) &&
           (limits_.max_scattering < 0 || s.in_media + end.in_media <= limits_.max_scattering);
  }
  void weigh(const Spectrum& own, const Spectrum& other, const Wavelengths& w, TestSegment& out) const {
    out.weigh(scene_.has_media(), own, techniques_.others(other), w);
  }

  // Hooks of the walk:
  int further_segments(int i, int k) const {
    const LightVertex<L>* end = states_[i].present_light;
    return k > 0 ? end->edges + end->crossed : 0;
  }
  bool has_technique(int s, int t) const { return techniques_.have(s, t); }
  const SensorSubpathDensity<L>& vertex_density(int i) const { return states_[i].arrived; }
  Spectrum* emission_in_media(int i) {
    return techniques_.have(0, states_[i].depth + 2) ? &path(i).result.estimate : nullptr;
  }
  void at_vertex(int i) {
    State& s = states_[i];
    const Vertex& vertex = vertices_[i];
    const Vec3 d = s.segment.ray.d;
    float spread = length_squared(vertex.p() - s.from.p);
    if (s.depth == 0) {
      const auto seen = scene_.sensor().eval(vertex.p(), d, path(i).film, path(i).wavelengths.time);
      spread = seen ? safe_inverse(seen->pdf_across) : 0.f;
    }
    s.arrived = s.density;
    s.arrived.arrive(!vertex.is_surface(), vertex.density_across(d), spread);
  }
  void extend(int i, const Scatter& b) {
    State& s = states_[i];
    const Vertex& vertex = vertices_[i];
    s.density = s.arrived;
    s.density.scatter(b, vertex.reverse_pdf(b), vertex.density_across(b.d));
  }
  /// Adds the emission of a light that the path has hit: the technique without a light path (s = 0).
  void emission(int i, const aureole::Light& light, const SurfacePoint* point, const Spectrum& radiance) {
    const State& s = states_[i];
    if (s.emission_counted || is_black(radiance) || !techniques_.have(0, s.depth + 2)) return;
    Spectrum all = s.density.r_u;
    const Vec3& d = s.segment.ray.d;
    const std::size_t part = point ? light.part_of(*point) : 0;
    // Light that the sensor sees directly is found by light sampling at receivers alone, apart from its rays.
    if (const Receiver* receiver = path(i).receiver; s.depth == 0 && receiver) {
      if (const float pdf = receiver->pdf(d); pdf > 0)
        all +=
            s.density.r_l * (light_density(scene_, s.from, light, part, point, d, wavelengths(i).time) / pdf);
    }
    if (s.depth > 0) {
      const float cosine = point ? std::abs(dot(point->ng, d)) : 1.f;
      all += techniques_.others(
          s.density.r_l * light_density(scene_, s.from, light, part, point, d, wavelengths(i).time) +
          s.density.earlier *
              (emission_density(scene_, light, part, point, -d, wavelengths(i).time) * safe_inverse(cosine)));
    }
    const Spectrum estimate = s.density.seen(radiance) / (wavelengths(i).pdf * sum(all));
    path(i).result.estimate += estimate;
    if (log_.follows(i)) this->log_emission(i, point, estimate);
  }

private:
  bool is_connectable(int i) { return !states_[i].last && vertices_[i].is_smooth(); }

  bool connect_with_light(int i, Connection& out) {
    State& s = states_[i];
    const Vertex& vertex = vertices_[i];
    Path& p = path(i);
    return connect_to_light(scene_, vertex, lights_[i], s.segment, s.arrived.beta, p.wavelengths,
                            key(p.samples, s.vertex, Stream::connection), out,
                            [&](const LightChoice& choice, const DirectSample& direct, const auto& response,
                                Spectrum& own, Spectrum& other) {
                              SurfacePoint emitting;
                              emitting.p = direct.p, emitting.ng = direct.ng;
                              emitting.time = p.wavelengths.time;
                              // The pdf of a light path to the vertex, with its position on the light per
                              // solid angle as seen from here.
                              const bool has_shape = choice.light->shape;
                              float emission = emission_density(scene_, *choice.light, choice.part,
                                                                has_shape ? &emitting : nullptr, -direct.wo,
                                                                p.wavelengths.time);
                              if (has_shape)
                                emission *= safe_inverse(std::abs(dot(direct.ng, direct.wo)));
                              else if (!direct.infinite)
                                emission *= safe_inverse(length_squared(direct.p - vertex.p()));
                              own = s.arrived.r_u * (choice.probability * direct.pdf);
                              other = s.arrived.others(vertex.reverse_pdf(direct.wo)) *
                                      vertex.density_across(direct.wo) * emission;
                              if (!direct.delta) other += s.arrived.r_u * response.pdf;
                              other = techniques_.others(other);
                            });
  }

  bool connect_with_vertex(int i, const LightVertex<L>& end, Connection& out) {
    const State& s = states_[i];
    const Vertex& vertex = vertices_[i];
    if (!may_connect(i, end)) return false;
    if (!vertex.is_surface() && !scene_.may_see(*s.segment.medium, end.vertex.p())) return false;
    const Vec3 to = end.vertex.p() - vertex.p();
    const float distance2 = length_squared(to);
    if (!(distance2 > 0)) return false;
    const Vec3 d = to * (1 / std::sqrt(distance2));
    typename Base::Response here, there;
    if (!vertex.respond(d, here) || !end.vertex.respond(-d, there)) return false;
    const float inverse = 1 / distance2;
    const Spectrum from_here = s.arrived.r_u * here.pdf * end.vertex.density_across(d) *
                               end.density.others(end.vertex.reverse_pdf(-d)),
                   from_there = end.density.r_u * there.pdf * vertex.density_across(d) *
                                s.arrived.others(vertex.reverse_pdf(d));
    out.set(vertex.origin(), d, end.vertex.origin());
    out.near = s.arrived.beta.after(here.value);
    out.far = L::scaled(there.value.of(end.density.beta), inverse);
    weigh(s.arrived.r_u * end.density.r_u, (from_here + from_there) * inverse, wavelengths(i), out);
    if (scene_.has_media())
      out.begin_in(vertex.leaving(d, s.segment),
                   std::uint32_t(combine_bits(key(path(i).samples, s.vertex, Stream::connection),
                                              std::uint64_t(end.edges))));
    return true;
  }

  static float safe_inverse(float x) { return x > 0 ? 1 / x : 0.f; }

  const Techniques& techniques_;
  PerPath<LightSample> lights_;
};

}  // namespace aureole::bdpt
