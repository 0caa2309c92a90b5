// SPDX-License-Identifier: Apache-2.0
// The driver: it follows the paths of a batch together. Their rays go to the ray tracer as packets, and each
// step of an integrator (what a ray meets, the connections of a vertex, the next direction) runs over all
// paths of the batch before the next step begins. Replaying one path is the same code.
//
// An integrator's steps are functions of a class, of which `path` is an index into the batch:
//     const Ray& ray(int path);                           the ray that the path goes on along
//     Event arrive(int path, const RayTracer::Hit& hit);  what it met: `surface` and `medium` are vertices,
//                                                         `crossed` is none; else the path has ended
//     bool connect(int path, Connection& out);            false: the vertex has no connection
//     bool needs_march();                                 whether connections may pass surfaces
//     void connected(int path, const Connection& c, bool open);
//     bool scatter(int path);                             false: the path ends here, or goes on below
//     PathList emerge();                                  those that went on below, at a vertex again
//     const Wavelengths& wavelengths(int path);
//     std::uint32_t connection_key(int path);             for random numbers of the vertex's connections
//     void lose(int path);                                the ray has left the range of float: the path ends,
//                                                         and its sample must become invalid
// and where there are
//     void put_segments(BatchConnections* room);          room for connections that `arrive` makes, from places
//                                                         along the segment that it has followed
//     void finish_looking();                              follows lines of sight that `arrive` has begun
//     bool looks_for_emission();                          whether vertices have a second connection,
//     bool connect_to_emission(int path, Connection& out);
//     bool looks_around_edges();          whether vertices are connected around edges, too,
//     void connect_around_edges(const PathList& vertices);
#pragma once

#include <type_traits>

#include "aureole/transport/batch.h"
#include "aureole/transport/connection.h"
#include "aureole/transport/edge_ledger.h"

namespace aureole {

/// All arrivals: traces the rays, and leaves in `rays` those of paths that crossed something. Returns the
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

/// Room for one connection of each path.
struct BatchConnections {
  BatchRays rays;
  Connection of_path[kBatch];
};

/// The end of a connection.
template <class Steps>
void end_connection(const Scene& scene, Steps& steps, int path, Connection& c, bool open) {
  if (open)
    lend_to_edges(scene, LightWay::of(c), steps.wavelengths(path), steps.connection_key(path), c.light);
  steps.connected(path, c, open);
}

/// Connections that may pass surfaces or media.
template <class Steps>
[[gnu::noinline]] void march_all(const Scene& scene, Steps& steps, BatchConnections& connections) {
  while (!connections.rays.empty())
    connections.rays.intersect(scene.tracer(), RayTracer::Rays::incoherent,
                               [&](int path, const RayTracer::Hit& hit) {
                                 Connection& c = connections.of_path[path];
                                 const Event event = cross(scene, hit, c, steps.wavelengths(path));
                                 if (event == Event::crossed) {
                                   connections.rays.add(path, c.flight.ray);
                                   return;
                                 }
                                 if (event == Event::escape && scene.has_media()) c.finish();
                                 end_connection(scene, steps, path, c, event == Event::escape);
                               });
}

/// One connection of each path, which `connect(path, connection)` makes.
template <class Steps, class Connect>
void connect_each(const Scene& scene, Steps& steps, const PathList& paths, BatchConnections& connections,
                  Connect&& connect) {
  for (const int path : paths) {
    Connection& c = connections.of_path[path];
    if (connect(path, c)) connections.rays.add(path, c.flight.ray);
  }
  if (steps.needs_march()) return march_all(scene, steps, connections);
  connections.rays.test_visibility(scene.tracer(), [&](int path, bool open) {
    Connection& c = connections.of_path[path];
    end_connection(scene, steps, path, c, open || is_lost(scene, c));
  });
}

/// One connection of each path with a light or the sensor.
template <class Steps>
void connect_all(const Scene& scene, Steps& steps, const PathList& paths, BatchConnections& connections) {
  connect_each(scene, steps, paths, connections,
               [&](int path, Connection& c) { return steps.connect(path, c); });
}

/// All connections of the vertices.
template <class Steps>
void connect_vertices(const Scene& scene, Steps& steps, const PathList& vertices,
                      BatchConnections& connections) {
  connect_all(scene, steps, vertices, connections);
  if constexpr (requires { steps.looks_for_emission(); })
    if (steps.looks_for_emission())
      connect_each(scene, steps, vertices, connections,
                   [&](int path, Connection& c) { return steps.connect_to_emission(path, c); });
  if constexpr (requires { steps.looks_around_edges(); })
    if (steps.looks_around_edges()) steps.connect_around_edges(vertices);
}

/// The next directions: adds the rays of the paths that go on.
template <class Steps>
void scatter_all(Steps& steps, const PathList& paths, BatchRays& rays) {
  for (const int path : paths)
    if (steps.scatter(path)) rays.add(path, steps.ray(path));
}

/// The exits of paths that have gone on below a surface, as vertices. Apart from the other steps, so that
/// these cost the same in scenes without such surfaces.
template <class Steps>
[[gnu::noinline]] void emerge_all(const Scene& scene, Steps& steps, BatchRays& rays,
                                  BatchConnections& connections) {
  const PathList vertices = steps.emerge();
  if (vertices.count == 0) return;
  connect_vertices(scene, steps, vertices, connections);
  scatter_all(steps, vertices, rays);
}

/// Follows the paths of `rays` to their ends. Steps without `connect` have no connections, those without
/// `scatter` no vertices, those without `emerge` no exits. Not inlined, so that the records of the batch lie
/// behind one pointer: on its caller's stack their addresses would be computed anew at every access.
template <class Steps>
[[gnu::noinline]] void follow(const Scene& scene, Steps& steps, BatchRays& rays, RayTracer::Rays kind) {
  constexpr bool kScatters = requires { steps.scatter(0); };
  constexpr bool kConnects = requires(Connection & c) { steps.connect(0, c); };
  constexpr bool kEmerges = requires { steps.emerge(); };
  constexpr bool kHasSegments = requires { steps.put_segments(nullptr); };
  std::conditional_t<kConnects, BatchConnections, char> connections;
  if constexpr (kHasSegments) steps.put_segments(&connections);
  for (; !rays.empty(); kind = RayTracer::Rays::incoherent) {
    [[maybe_unused]] const PathList vertices = arrive_all(scene, steps, rays, kind);
    if constexpr (kHasSegments)
      if (!connections.rays.empty()) march_all(scene, steps, connections);
    if constexpr (requires { steps.finish_looking(); }) steps.finish_looking();
    if constexpr (kConnects) connect_vertices(scene, steps, vertices, connections);
    if constexpr (kScatters) scatter_all(steps, vertices, rays);
    if constexpr (kEmerges)
      if (scene.has_exits()) emerge_all(scene, steps, rays, connections);
  }
  if constexpr (kHasSegments) steps.put_segments(nullptr);
}

}  // namespace aureole
