// SPDX-License-Identifier: Apache-2.0
// `Driver`: it follows the paths of a batch together. Their rays go to the ray tracer as packets, and each
// phase of a step runs over the list of all paths of the batch before the next phase begins, so that what one
// phase calls stays in the caches. Replaying one path is the same code.
//
// Steps are functions of a class, `Walk` or another one, of which `path` is an index into the batch:
//     const Ray& ray(int path);             the ray that the path goes on along
//     Event locate(int path, const RayTracer::Hit& hit);
//                                           where the ray leads to: `medium`, a vertex there; `surface`, on which
//                                           `emit` decides; `crossed`, the path goes on; else it has ended
//     void lose(int path);                  the ray has left the range of float: the path ends, and its sample
//                                           must become invalid
// and, for steps whose paths have vertices, all of
//     Event emit(int path);                 emission of the surface that `locate` has found; `surface` where the path
//                                           has a vertex there
//     bool scatter(int path);               false: the path ends here, or continues below the surface
//     int connection_count(int path);       upper bound of the number of connections of the vertex
//     bool connect(int path, int k, Connection& out);
//                                           makes the k-th connection; false where there is none
//     void end_connection(int path, int k, const Connection& c, bool open);
//                                           k = -1: from a position along the ray
//     bool needs_march();                   whether connections may cross surfaces
//     const Wavelengths& wavelengths(int path);
//     std::uint32_t connection_key(int path);
//                                           for random numbers of the vertex's connections
//     void connect_edges(const PathList& vertices);
//                                           light around edges, for all vertices
// and, where they have them,
//     void connected_all(const PathList& vertices);
//                                           further next-event estimation, once for all vertices
//     BatchConnections<Connection>* along_rays();
//                                           connections that `locate` has made, from positions along the rays; null:
//                                           the steps make none
//     void finish_lines();                  follows lines of sight that `locate` has begun
//     void choose(int path, int k);         chooses the other end of the k-th connection of the vertex, for `connect`
//     int crossings_left(int path, int k);  number of surfaces that it may cross
//     void emerge(PathList& vertices);      adds the paths that continued below a surface, at a vertex again
#pragma once

#include <type_traits>

#include "aureole/transport/batch.h"
#include "aureole/transport/connection.h"
#include "aureole/transport/diffraction.h"

namespace aureole {

/// Storage of one connection of each path.
template <class Connection>
struct BatchConnections {
  BatchConnections(Arena& arena, std::size_t paths)
      : rays(arena, paths), of_path(arena.make<Connection>(paths).data()) {}
  BatchRays rays;
  Connection* of_path;
};

/// The connections of steps, if they have any.
template <class Steps>
struct ConnectionsOf {
  ConnectionsOf(Arena&, std::size_t) {}
};
template <class Steps>
requires requires { typename Steps::Connection; }
struct ConnectionsOf<Steps> : BatchConnections<typename Steps::Connection> {
  using BatchConnections<typename Steps::Connection>::BatchConnections;
};

template <class Steps>
class Driver {
public:
  /// `paths`: the number of paths of the batch, whose lists and connections lie in the arena.
  Driver(const Scene& scene, Steps& steps, Arena& arena, std::size_t paths)
      : scene_(scene),
        steps_(steps),
        rays_(arena, paths),
        surfaces_(arena, paths),
        vertices_(arena, paths),
        connections_(arena, paths) {}
  Driver(const Driver&) = delete;
  Driver& operator=(const Driver&) = delete;

  /// The rays of paths that `follow` will follow.
  BatchRays& rays() { return rays_; }

  /// Follows the paths of `rays` to their ends; `kind` is that of their first rays. Steps without `scatter` have
  /// no vertices, those without `emerge` no exits. Not inlined, so that each walk has this code once.
  [[gnu::noinline]] void follow(RayTracer::Rays kind) {
    for (; !rays_.empty(); kind = RayTracer::Rays::incoherent) {
      arrive(kind);
      if constexpr (requires { steps_.scatter(0); }) {
        if constexpr (requires { steps_.along_rays(); })
          if (auto* made = steps_.along_rays(); made && !made->rays.empty()) march(*made, -1);
        if constexpr (requires { steps_.finish_lines(); }) steps_.finish_lines();
        connect();
        scatter();
        if constexpr (requires { steps_.emerge(vertices_); })
          if (scene_.has_exits()) emerge();
      }
    }
  }

private:
  /// Traces the rays, and makes `vertices_` the list of paths that are at a vertex. Rays of paths that crossed a
  /// surface are in `rays_` afterwards.
  void arrive(RayTracer::Rays kind) {
    surfaces_.clear(), vertices_.clear();
    const auto sort = [&](int path, Event event, PathList& on_surfaces) {
      if (event == Event::surface)
        on_surfaces.add(path);
      else if (event == Event::medium)
        vertices_.add(path);
      else if (event == Event::crossed)
        rays_.add(path, steps_.ray(path));
    };
    rays_.intersect(scene_.tracer(), kind, [&](int path, const RayTracer::Hit& hit) {
      if (hit.is_lost()) return steps_.lose(path);
      sort(path, steps_.locate(path, hit), surfaces_);
    });
    if constexpr (requires { steps_.scatter(0); })
      for (const int path : surfaces_) sort(path, steps_.emit(path), vertices_);
  }

  /// Tests all connections of the vertices.
  void connect() {
    connect_each(vertices_, 0);
    connect_further();
    if constexpr (requires { steps_.connected_all(vertices_); }) steps_.connected_all(vertices_);
    steps_.connect_edges(vertices_);
  }
  /// Tests the connections of vertices after the first connection of each.
  [[gnu::noinline]] void connect_further() {
    PathList& rest = surfaces_;
    rest.clear();
    for (const int path : vertices_)
      if (steps_.connection_count(path) > 1) rest.add(path);
    for (int k = 1; !rest.empty(); ++k) {
      connect_each(rest, k);
      rest.keep([&](int path) { return k + 1 < steps_.connection_count(path); });
    }
  }
  /// Tests the k-th connection of each path.
  [[gnu::always_inline]] inline void connect_each(const PathList& paths, int k) {
    if constexpr (requires { steps_.choose(0, 0); })
      for (const int path : paths) steps_.choose(path, k);
    for (const int path : paths) {
      auto& c = connections_.of_path[path];
      if (!steps_.connect(path, k, c)) continue;
      c.crossings_left = steps_.crossings_left(path, k);
      c.goes_behind = scene_.outline_edges() != nullptr;
      c.ray.time = steps_.wavelengths(path).time;
      connections_.rays.add(path, c.ray);
    }
    if (steps_.needs_march()) return march(connections_, k);
    connections_.rays.test_visibility(scene_.tracer(), [&](int path, bool open) {
      auto& c = connections_.of_path[path];
      end_connection(path, k, c, open || is_lost(scene_, c));
    });
  }
  /// Tests connections that may cross surfaces or media.
  template <class Connection>
  [[gnu::noinline]] void march(BatchConnections<Connection>& connections, int k) {
    BatchRays& rays = connections.rays;
    while (!rays.empty())
      rays.intersect(scene_.tracer(), RayTracer::Rays::incoherent, [&](int path, const RayTracer::Hit& hit) {
        auto& c = connections.of_path[path];
        const Event event = cross(scene_, hit, c, steps_.wavelengths(path));
        if (event == Event::crossed) {
          rays.add(path, c.ray);
          return;
        }
        if (event == Event::escape && scene_.has_media()) c.finish();
        end_connection(path, k, c, event == Event::escape);
      });
  }
  /// Hands the result of a connection to the steps.
  template <class Connection>
  void end_connection(int path, int k, Connection& c, bool open) {
    if (open || scene_.outline_edges())
      open = apply_diffraction(scene_, c, open, steps_.wavelengths(path), steps_.connection_key(path));
    steps_.end_connection(path, k, c, open);
  }

  /// Samples the next directions, and adds the rays of the paths that go on.
  void scatter() {
    for (const int path : vertices_)
      if (steps_.scatter(path)) rays_.add(path, steps_.ray(path));
  }

  /// Samples the exits of paths that were refracted below a surface, as vertices. It is apart from the other
  /// phases, so that they cost the same in scenes without such surfaces.
  [[gnu::noinline]] void emerge() {
    vertices_.clear();
    steps_.emerge(vertices_);
    if (vertices_.empty()) return;
    connect();
    scatter();
  }

  const Scene& scene_;
  Steps& steps_;
  BatchRays rays_;
  PathList surfaces_, vertices_;
  ConnectionsOf<Steps> connections_;
};

}  // namespace aureole
