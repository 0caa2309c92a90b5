// SPDX-License-Identifier: Apache-2.0
// Shared by path and light tracing: limits of the length of paths, and the lines that a replay logs for
// their vertices.
#pragma once

#include <fmt/format.h>

#include <algorithm>

#include "aureole/integrator/integrator.h"
#include "aureole/transport/connection.h"

namespace aureole {

/// The parameters `max_depth`, `rr_depth`, `max_scattering` and `hide_emitters`.
struct PathLimits {
  /// Inside a closed shape without losses no path would end without roulette.
  static constexpr int kLatestRoulette = 1000;

  explicit PathLimits(const Properties& p)
      : max_depth(int(p.get_int("max_depth", -1, {-1, 1e9}))),
        roulette_depth(std::min(int(p.get_int("rr_depth", 5, {1, 1e9})), kLatestRoulette)),
        max_scattering(int(p.get_int("max_scattering", -1, {-1, 1e9}))),
        hide_emitters(p.get_bool("hide_emitters", false)) {}

  /// The largest probability of surviving roulette, after so many scattering events. Paths in media that hardly
  /// absorb are long: a loss of 5 % at every vertex would make the few that survive hundreds of times as bright as
  /// the others. A loss of 1/(2 n) at the n-th, between the 500th and the 10,000th, lets their weights grow as the root
  /// of n; before and after it is constant, .001 and .00005 (docs/decisions/0099-long-path-roulette.md).
  static float most_survival(const Scene& scene, int scattered) {
    return scene.has_media() ? 1 - std::clamp(0.5f / float(scattered + 1), 5e-5f, 1e-3f) : 0.95f;
  }

  /// Whether paths of so many edges count.
  bool reaches(int edges) const { return max_depth < 0 || edges <= max_depth; }

  int max_depth;  ///< longest path in edges; -1: no limit
  int roulette_depth;
  int max_scattering;  ///< most scattering events in media; -1: no limit
  bool hide_emitters;
};

inline void log_surface(const BatchLog& log, int depth, const SurfacePoint& hit, float throughput) {
  log(fmt::format("  depth {}: {} \"{}\" at ({:.6g}, {:.6g}, {:.6g}), bsdf {}, throughput {:.6g}", depth,
                  hit.shape->properties().type(), hit.shape->id(), hit.p.x, hit.p.y, hit.p.z,
                  hit.surface->bsdf->properties().type(), throughput));
}

inline void log_escape(const BatchLog& log, int depth, const Vec3& d) {
  log(fmt::format("  depth {}: escapes along ({:.6g}, {:.6g}, {:.6g})", depth, d.x, d.y, d.z));
}

/// The beginning of a path of light, `ray`.
inline void log_emitter(const BatchLog& log, const Light& light, std::size_t part, const Ray& ray) {
  log(fmt::format("  emitter \"{}\", part {}: from ({:.6g}, {:.6g}, {:.6g}) along ({:.6g}, {:.6g}, {:.6g})",
                  light.properties().type(), part, ray.o.x, ray.o.y, ray.o.z, ray.d.x, ray.d.y, ray.d.z));
}

inline void log_seen(const BatchLog& log, Vec2 film, const Connection& c, bool open) {
  log(fmt::format("  sensor at ({:.6g}, {:.6g}) on the film: {} mean {:.6g}", film.x, film.y,
                  open ? "visible" : "hidden", open ? mean(c.light) : 0.f));
}

inline void log_exit(const BatchLog& log, const SurfacePoint& exit, float throughput) {
  log(fmt::format("  enters, and leaves at ({:.6g}, {:.6g}, {:.6g}), throughput {:.6g}", exit.p.x, exit.p.y,
                  exit.p.z, throughput));
}

inline void log_edge(const BatchLog& log, int depth, const Vec3& p) {
  log(fmt::format("  depth {}: edge at ({:.6g}, {:.6g}, {:.6g})", depth, p.x, p.y, p.z));
}

inline void log_medium(const BatchLog& log, int depth, const Vec3& p, const Medium& medium,
                       float throughput) {
  log(fmt::format("  depth {}: scattered by {} \"{}\" at ({:.6g}, {:.6g}, {:.6g}), throughput {:.6g}", depth,
                  medium.properties().type(), medium.id(), p.x, p.y, p.z, throughput));
}

}  // namespace aureole
