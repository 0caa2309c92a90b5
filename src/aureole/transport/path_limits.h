// SPDX-License-Identifier: Apache-2.0
// `PathLimits`: the parameters of integrators that limit the length of paths.
#pragma once

#include <algorithm>
#include <limits>

#include "aureole/plugin/properties.h"
#include "aureole/scene/scene.h"

namespace aureole {

/// Number of allowed crossings where `max_depth` does not limit them.
inline constexpr int kUnlimitedCrossings = std::numeric_limits<int>::max();

/// The parameters `max_depth`, `count_crossings`, `rr_depth`, `max_scattering` and `hide_emitters`.
struct PathLimits {
  /// Largest depth at which Russian roulette begins: inside a closed shape without losses no path would end
  /// without it.
  static constexpr int kLatestRoulette = 1000;

  explicit PathLimits(const Properties& p)
      : max_depth(int(p.get_int("max_depth", -1, {-1, 1e9}))),
        roulette_depth(std::min(int(p.get_int("rr_depth", 5, {1, 1e9})), kLatestRoulette)),
        max_scattering(int(p.get_int("max_scattering", -1, {-1, 1e9}))),
        hide_emitters(p.get_bool("hide_emitters", false)),
        counts_crossings(p.get_bool("count_crossings", true) && max_depth >= 0) {}

  /// Direct light: two segments, or three around an edge that diffracts.
  static PathLimits direct(bool hide_emitters) { return PathLimits(3, kLatestRoulette, -1, hide_emitters); }

  /// Upper bound of the survival probability of Russian roulette after `depth` scattering events. Paths in media
  /// of high albedo and between nearly white walls are long: a loss of 5 % at every vertex would make the few that
  /// survive hundreds of times as bright as the others. The loss at the n-th event is 1/(2 n), clamped to [0.00005,
  /// 0.001], so that the throughput of surviving paths grows as the square root of n
  /// (docs/decisions/0099-long-path-roulette.md, 0148-white-walls.md).
  static float max_survival(int depth) { return 1 - std::clamp(0.5f / float(depth + 1), 5e-5f, 1e-3f); }

  /// Number of crossings that the limit allows to a path of `segments` segments.
  int crossings_left(int segments) const {
    return counts_crossings ? max_depth - segments : kUnlimitedCrossings;
  }
  /// Whether crossing that surface counts.
  bool counts(const Surface& surface) const { return counts_crossings && !surface.is_null(); }
  /// Whether paths of `segments` segments count.
  bool reaches(int segments) const { return max_depth < 0 || segments <= max_depth; }

  int max_depth;  ///< longest path in segments; -1: no limit
  int roulette_depth;
  int max_scattering;  ///< most scattering events in media; -1: no limit
  bool hide_emitters;
  /// Whether crossing a surface that also scatters light, such as a mask or a thin pane, counts for `max_depth`.
  bool counts_crossings = false;

private:
  PathLimits(int depth, int roulette, int scattering, bool hide)
      : max_depth(depth), roulette_depth(roulette), max_scattering(scattering), hide_emitters(hide) {}
};

}  // namespace aureole
