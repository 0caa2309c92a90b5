// SPDX-License-Identifier: Apache-2.0
// A rendering job: work units, each a tile x sample block, on several threads, with progress, checkpoints,
// interruption and resumption.
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
#include "aureole/loading/load.h"
#include "aureole/render/plan.h"
#include "aureole/render/state.h"
#include "aureole/render/unit_renderer.h"
#include "aureole/scene/scene.h"

namespace aureole {

struct Progress {
  std::int64_t units_done, units;
  double seconds, samples_per_second;
};

class RenderJob {
public:
  /// Throws Error as `planned_state` does.
  RenderJob(const LoadedScene& loaded, const RenderOptions& options);

  /// Continues from a saved state. Throws Error if the state belongs to another picture.
  void resume(RenderState state);

  enum class Outcome { finished, interrupted, time_limit };
  /// Removes the state file of a finished job, unless it is to be kept, if this job or the one it continues
  /// wrote it. Call it after the pictures are written.
  void remove_state() const;
  /// Error message of the last checkpoint, or an empty string where it was written.
  const std::string& checkpoint_problem() const { return checkpoint_problem_; }

  /// Renders all units that are not done. A signal handler may set `stop`. `report` is called from one
  /// thread, a few times a second.
  Outcome run(const std::atomic<bool>& stop, const std::function<void(const Progress&)>& report = {});

  const RenderState& state() const { return state_; }
  /// Returns a consistent copy of the state while `run` is active (for previews).
  RenderState snapshot() const;
  /// The first few invalid samples found.
  const std::vector<InvalidSample>& invalid_samples() const { return invalid_; }

  const Integrator& integrator() const { return *integrator_; }
  /// Traces a sample of a pixel again, in the same batch as the job does, and logs its events. Pixel
  /// coordinates are the film's.
  ReplayedSample replay(int x, int y, std::int64_t sample, int replicate, const PathLog& log) const;
  /// Traces a block of samples [first, last) of a pixel again, at most kBatch, without a log.
  std::vector<ReplayedSample> replay_block(int x, int y, std::int64_t first, std::int64_t last,
                                           int replicate) const;

private:
  /// Computes the densities of adaptive sampling; leaves them unset if `stop` interrupts it. `report` is
  /// called from one thread with the number of tiles traced, last with all of them.
  void find_densities(int threads, const std::atomic<bool>& stop,
                      const std::function<void(std::int64_t)>& report);
  void render_unit(std::int64_t unit, UnitResult& result);
  /// Counts a unit as done. The caller must hold `lock_`.
  void count_as_done(std::int64_t unit, const std::vector<InvalidSample>& invalid);
  void checkpoint(double seconds);
  /// Measures the errors of the integrator's approximations for a picture that is finished.
  void measure_approximations(int threads);
  /// Updates the splat weights of the state to the units done. The caller must hold both locks.
  void finish(RenderState& state) const;

  std::shared_ptr<const Scene> scene_;
  std::shared_ptr<const Integrator> integrator_;
  RenderOptions options_;
  std::shared_ptr<const UnitRenderer> renderer_;
  RenderState state_;
  /// samples of the pilot, kept until the units that contain them are rendered
  std::shared_ptr<const Pilot> pilot_;
  std::atomic<std::int64_t> pilot_tiles_left_{0};
  bool wrote_state_ = false;
  std::string checkpoint_problem_;
  std::vector<InvalidSample> invalid_;
  struct Lock;
  std::shared_ptr<Lock> lock_;  ///< guards state_ and invalid_ while units are added
};

}  // namespace aureole
