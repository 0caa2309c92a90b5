// SPDX-License-Identifier: Apache-2.0
// The driver: it follows the paths of a batch together. Their rays go to the ray tracer as packets, and each
// step (arrive, connect, scatter, emerge; see transport/walk.h) runs over all paths of the batch before the
// next step begins. Replaying one path is the same code.
//
// Steps are functions of a class, `Walk` or another one, of which `path` is an index into the batch:
//     const Ray& ray(int path);             the ray that the path goes on along
//     Event arrive(int path, const RayTracer::Hit& hit);
//                                           what the ray has hit: `surface` and `medium` are vertices, `crossed`
//                                           is none; else the path has ended
//     void lose(int path);                  the ray has left the range of float: the path ends, and its sample
//                                           must become invalid
// and, for steps that have them,
//     int connection_count(int path);       upper bound of the number of connections of the vertex
//     bool connect(int path, int k, Connection& out);
//                                           makes the k-th connection; false where there is none
//     void end_connection(int path, int k, const Connection& c, bool open);
//                                           k = -1: from a position along the ray
//     bool needs_march();                   whether connections may cross surfaces
//     const Wavelengths& wavelengths(int path);
//     std::uint32_t connection_key(int path);
//                                           for random numbers of the vertex's connections
//     void connected_all(const PathList& vertices);
//     void connect_edges(const PathList& vertices);
//                                           further next-event estimation, once for all vertices
//     void put_segments(BatchConnections<Connection>* room);
//                                           storage of connections that `arrive` makes, from positions along the ray
//     void finish_lines();                  follows lines of sight that `arrive` has begun
//     bool scatter(int path);               false: the path ends here, or continues below the surface
//     PathList emerge();                    paths that continued below a surface, at a vertex again
#pragma once

#include <type_traits>

#include "aureole/transport/batch.h"
#include "aureole/transport/connection.h"
#include "aureole/transport/diffraction.h"

namespace aureole {

/// Arrive step: traces the rays, and leaves in `rays` the rays of paths that crossed a surface. Returns the
/// paths that are at a vertex.
template <class Steps>
PathList arrive_all(const Scene& scene, Steps& steps, BatchRays& rays, RayTracer::Rays kind) {
  PathList vertices;
  rays.intersect(scene.tracer(), kind, [&](int path, const RayTracer::Hit& hit) {
    if (hit.is_lost()) return steps.lose(path);
    const Event event = steps.arrive(path, hit);
    if (event == Event::surface || event == Event::medium)
      vertices.add(path);
    else if (event == Event::crossed)
      rays.add(path, steps.ray(path));
  });
  return vertices;
}

/// Storage of one connection of each path.
template <class Connection>
struct BatchConnections {
  BatchRays rays;
  Connection of_path[kBatch];
};

/// Hands the result of a connection to the steps.
template <class Steps, class Connection>
void end_connection(const Scene& scene, Steps& steps, int path, int k, Connection& c, bool open) {
  if (open || scene.outline_edges())
    open = apply_diffraction(scene, c, open, steps.wavelengths(path), steps.connection_key(path));
  steps.end_connection(path, k, c, open);
}

/// Tests connections that may cross surfaces or media.
template <class Steps, class Connection>
[[gnu::noinline]] void march_all(const Scene& scene, Steps& steps, int k,
                                 BatchConnections<Connection>& connections) {
  while (!connections.rays.empty())
    connections.rays.intersect(scene.tracer(), RayTracer::Rays::incoherent,
                               [&](int path, const RayTracer::Hit& hit) {
                                 Connection& c = connections.of_path[path];
                                 const Event event = cross(scene, hit, c, steps.wavelengths(path));
                                 if (event == Event::crossed) {
                                   connections.rays.add(path, c.ray);
                                   return;
                                 }
                                 if (event == Event::escape && scene.has_media()) c.finish();
                                 end_connection(scene, steps, path, k, c, event == Event::escape);
                               });
}

/// Tests the k-th connection of each path.
template <class Steps, class Connection>
[[gnu::always_inline]] inline void connect_each(const Scene& scene, Steps& steps, const PathList& paths,
                                                int k, BatchConnections<Connection>& connections) {
  for (const int path : paths) {
    Connection& c = connections.of_path[path];
    if (!steps.connect(path, k, c)) continue;
    if constexpr (requires { steps.crossings_left(path, k); })
      c.crossings_left = steps.crossings_left(path, k);
    c.goes_behind = scene.outline_edges() != nullptr;
    c.ray.time = steps.wavelengths(path).time;
    connections.rays.add(path, c.ray);
  }
  if (steps.needs_march()) return march_all(scene, steps, k, connections);
  connections.rays.test_visibility(scene.tracer(), [&](int path, bool open) {
    Connection& c = connections.of_path[path];
    end_connection(scene, steps, path, k, c, open || is_lost(scene, c));
  });
}

/// Tests the connections of vertices after the first connection of each.
template <class Steps, class Connection>
[[gnu::noinline]] void connect_further(const Scene& scene, Steps& steps, const PathList& vertices,
                                       BatchConnections<Connection>& connections) {
  PathList rest = vertices;
  for (int k = 1;; ++k) {
    PathList next;
    for (const int path : rest)
      if (k < steps.connection_count(path)) next.add(path);
    if (next.count == 0) return;
    connect_each(scene, steps, next, k, connections);
    rest = next;
  }
}

/// Tests all connections of the vertices.
template <class Steps, class Connection>
void connect_vertices(const Scene& scene, Steps& steps, const PathList& vertices,
                      BatchConnections<Connection>& connections) {
  connect_each(scene, steps, vertices, 0, connections);
  if constexpr (requires { steps.connection_count(0); }) connect_further(scene, steps, vertices, connections);
  if constexpr (requires { steps.connected_all(vertices); }) steps.connected_all(vertices);
  if constexpr (requires { steps.connect_edges(vertices); }) steps.connect_edges(vertices);
}

/// Scatter step: samples the next directions, and adds the rays of the paths that go on.
template <class Steps>
void scatter_all(Steps& steps, const PathList& paths, BatchRays& rays) {
  for (const int path : paths)
    if (steps.scatter(path)) rays.add(path, steps.ray(path));
}

/// Emerge step: samples the exits of paths that were refracted below a surface, as vertices. It is apart from
/// the other steps, so that they cost the same in scenes without such surfaces.
template <class Steps, class Connection>
[[gnu::noinline]] void emerge_all(const Scene& scene, Steps& steps, BatchRays& rays,
                                  BatchConnections<Connection>& connections) {
  const PathList vertices = steps.emerge();
  if (vertices.count == 0) return;
  connect_vertices(scene, steps, vertices, connections);
  scatter_all(steps, vertices, rays);
}

/// Follows the paths of `rays` to their ends. Steps without a type `Connection` have no connections, those
/// without `scatter` no vertices, those without `emerge` no exits. Not inlined, so that the records of the
/// batch lie behind one pointer: on its caller's stack their addresses would be computed anew at every
/// access.
template <class Steps>
[[gnu::noinline]] void follow(const Scene& scene, Steps& steps, BatchRays& rays, RayTracer::Rays kind) {
  if constexpr (!requires { steps.scatter(0); }) {
    for (; !rays.empty(); kind = RayTracer::Rays::incoherent) arrive_all(scene, steps, rays, kind);
  } else {
    BatchConnections<typename Steps::Connection> connections;
    constexpr bool kHasSegments = requires { steps.put_segments(&connections); };
    if constexpr (kHasSegments) steps.put_segments(&connections);
    for (; !rays.empty(); kind = RayTracer::Rays::incoherent) {
      const PathList vertices = arrive_all(scene, steps, rays, kind);
      if constexpr (kHasSegments)
        if (!connections.rays.empty()) march_all(scene, steps, -1, connections);
      if constexpr (requires { steps.finish_lines(); }) steps.finish_lines();
      connect_vertices(scene, steps, vertices, connections);
      scatter_all(steps, vertices, rays);
      if constexpr (requires { steps.emerge(); })
        if (scene.has_exits()) emerge_all(scene, steps, rays, connections);
    }
    if constexpr (kHasSegments) steps.put_segments(nullptr);
  }
}

}  // namespace aureole
