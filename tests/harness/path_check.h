// SPDX-License-Identifier: Apache-2.0
// `PathCheck`: compares everything that the log of a replayed path reports with `PathOracle`.
#pragma once

#include <set>
#include <utility>

#include "aureole/transport/path.h"
#include "aureole/transport/path_log.h"
#include "harness/path_oracle.h"

namespace aureole::testing {

/// Fails the test, by GoogleTest, where an estimate, a visibility test or a position on the film is wrong, or
/// a connection or a hit of a light is missing.
class PathCheck {
public:
  /// `max_depth`: of the integrator, segments.
  PathCheck(const ClosedFormScene& scene, PathOracle oracle, int max_depth);

  /// Before the events of a path, with its ray and wavelengths.
  void begin(const Path& path);
  void operator()(const PathEvent& e);
  /// After them, with its results.
  void end(const Path& path, const std::vector<Splat>& splats);

  /// Numbers of estimates compared, by the technique that has found the path, and of others.
  struct Counts {
    int hit = 0;       ///< the walk from the sensor has hit the light
    int light = 0;     ///< light sampling
    int along = 0;     ///< light sampling from a point along the ray
    int vertex = 0;    ///< connections of two walks
    int sensor = 0;    ///< connections with the sensor
    int seen = 0;      ///< lines of sight
    int occluded = 0;  ///< connections without an estimate
    int mirror = 0;    ///< paths with a mirror
    int spectral = 0;  ///< paths whose pdf differs by more than a tenth between wavelengths
    int near = 0;      ///< paths that were not compared: see `kNear`

    int compared() const { return hit + light + along + vertex + sensor + seen - near; }
  };
  const Counts& counts() const { return counts_; }

private:
  using Kind = OracleVertex::Kind;

  void arrive(const PathEvent& e);
  OracleVertex light_at(const PathEvent& e) const;
  void compare(const OraclePath& path, const PathEvent& e, bool is_splat);
  void compare_visibility(const OracleVertex& a, const OracleVertex& b, const PathEvent& e);
  void connect(const PathEvent& e);
  void see(const PathEvent& e);
  void find_missing() const;
  /// Fails unless the path is connected between its vertices i - 1 and i, or carries no light there.
  void expect_found(bool is_found, const OraclePath& path, std::size_t i) const;
  /// A path from the light to the last vertices of the walk from the sensor, of which it has `count`.
  OraclePath joined(OraclePath path, std::size_t count) const;

  const ClosedFormScene& scene_;
  PathOracle oracle_;
  std::size_t max_depth_;
  OracleVertex pinhole_;
  Path path_;
  OraclePath light_, sensor_;  ///< walks, each from its beginning
  bool of_sensor_ = false;     ///< events are of the walk from the sensor
  std::size_t ray_start_ = 0;  ///< number of vertices up to the origin of the ray that was followed last
  /// Vertices of the two walks, by their numbers of segments from the beginning, that have been connected;
  /// with 0 segments from the sensor: with the sensor.
  std::set<std::pair<std::size_t, std::size_t>> connected_;
  std::set<std::size_t> hits_;  ///< numbers of segments of paths that have hit a light on a surface
  PerWavelength pixel_{},
      splats_{};  ///< sums of the estimates of the pixel and of those anywhere on the film
  Counts counts_;
};

}  // namespace aureole::testing
