// SPDX-License-Identifier: Apache-2.0
// A rendering job: work units of tile x sample block over threads, with progress, checkpoints, interruption
// and resumption.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "aureole/integrator/integrator.h"
#include "aureole/render/state.h"
#include "aureole/scene/scene.h"

namespace aureole {

struct RenderOptions {
  std::int64_t begin = 0;
  std::optional<std::int64_t> end;  ///< samples per pixel; default: the scene's sample_count
  std::optional<std::uint64_t> seed;
  std::optional<AdaptiveTarget> adaptive;  ///< default: the sampler's
  int threads = 0;                         ///< 0: all cores
  int replicates = 1;                      ///< independently scrambled renders, for variances
  double time_limit_s = 0;  ///< 0: none; else ends after the first whole block that every pixel has
  double checkpoint_interval_s = 30;
  std::filesystem::path state_file;  ///< empty: no checkpoints
  bool keep_state = false;           ///< keep the state file of a finished job
};

struct Progress {
  std::int64_t units_done, units;
  double seconds, samples_per_second;
};

struct CameraUnit;
struct Pilot;
class CameraRenderer;
struct SplatUnit;
class SplatRenderer;

class RenderJob {
public:
  /// Throws Error: a sample range that cuts blocks, a film too large for memory, wrong integrator.
  RenderJob(std::shared_ptr<const Scene> scene, const RenderOptions& options);

  /// Continues from a saved state. Throws Error where it belongs to another picture.
  void resume(RenderState state);

  enum class Outcome { finished, interrupted, time_limit };
  /// Removes the state file of a finished job, if this job or the one it continues wrote it and it is not to
  /// be kept: called after the pictures are safe.
  void remove_state() const;
  /// What went wrong with the last checkpoint, or an empty string.
  const std::string& checkpoint_problem() const { return checkpoint_problem_; }

  /// Renders what is missing. `stop` may be set by a signal handler. `report` is called from one thread, a
  /// few times a second.
  Outcome run(const std::atomic<bool>& stop, const std::function<void(const Progress&)>& report = {});

  const RenderState& state() const { return state_; }
  /// A consistent copy while `run` is going on (previews).
  RenderState snapshot() const;
  /// The first few invalid samples met.
  const std::vector<InvalidSample>& invalid_samples() const { return invalid_; }

  /// Whether paths start at emitters, so that those of a pixel's samples belong to no pixel.
  bool traces_light() const { return splats_ != nullptr; }
  /// Replays one sample of a pixel, logging its vertices; returns its measured channels, nothing where one
  /// was invalid. Pixel coordinates are the film's. Of a light path the channels of all splats follow one
  /// another.
  std::optional<std::vector<float>> replay(int x, int y, std::int64_t sample, int replicate,
                                           const PathLog& log) const;

private:
  /// Sets the densities of adaptive sampling; leaves them where `stop` ends it. `report` is called from one
  /// thread with the tiles traced, at last with all of them.
  void find_densities(int threads, const std::atomic<bool>& stop,
                      const std::function<void(std::int64_t)>& report);
  void render_unit(std::int64_t unit, CameraUnit& result);
  void render_light_unit(std::int64_t unit);
  /// Notes that a unit is done. While `lock_` is held.
  void count_as_done(std::int64_t unit, const std::vector<InvalidSample>& invalid);
  void checkpoint(double seconds);

  std::shared_ptr<const Scene> scene_;
  std::shared_ptr<const CameraRenderer> camera_;  ///< or
  std::shared_ptr<const SplatRenderer> splats_;   ///< for paths from the emitters
  RenderOptions options_;
  FilterTable filter_;
  RenderState state_;
  std::shared_ptr<const Pilot> pilot_;  ///< while units that hold its samples are to be rendered
  std::atomic<std::int64_t> pilot_tiles_left_{0};
  bool wrote_state_ = false;
  std::string checkpoint_problem_;
  std::vector<InvalidSample> invalid_;
  struct Lock;
  std::shared_ptr<Lock> lock_;  ///< guards state_ and invalid_ while units are added
};

/// What a film does to measured values, as matrices; `aovs` are stored as they are.
Development development_of(const Film& film, const std::vector<std::string>& aovs = {});

}  // namespace aureole
