// SPDX-License-Identifier: Apache-2.0
// The planning of a job: its options, their checks, and the empty state that the job fills.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "aureole/loading/load.h"
#include "aureole/render/state.h"

namespace aureole {

struct RenderOptions {
  std::int64_t begin = 0;
  std::optional<std::int64_t> end;  ///< samples per pixel; default: the scene's sample_count
  std::optional<std::uint64_t> seed;
  std::optional<AdaptiveTarget> adaptive;  ///< default: the sampler's target
  int threads = 0;                         ///< 0: all cores
  int replicates = 1;                      ///< independently scrambled renderings, for variances
  double time_limit_s = 0;  ///< 0: none; else ends after the first whole block that every pixel has
  double checkpoint_interval_s = 30;
  /// Units of the samples [begin, end) that are rendered, for parts on several machines; by default all. A time limit
  /// does not go with it.
  std::optional<UnitRanges::Range> units;
  std::filesystem::path state_file;  ///< empty: no checkpoints
  bool keep_state = false;           ///< keep the state file of a finished job
};

/// Divides the samples of a picture that will be denoised among replicates, whose differences give the variance by which
/// pixels without noise are kept: 4 of at least 16 samples each, or 2 or 3 where there are fewer. Replicates that the
/// options state stay.
void divide_for_denoising(const LoadedScene& loaded, RenderOptions& options);

/// Returns the state of a picture without samples. Throws Error for: a sample range that splits blocks, a
/// film too large for memory, too wide a filter, no integrator, adaptive sampling with an integrator that
/// only splats.
RenderState planned_state(const LoadedScene& loaded, const RenderOptions& options);

/// The film's linear map from measured values to channels, as matrices; AOVs are stored unchanged.
Development development_of(const Film& film, const std::vector<std::string>& aovs = {},
                           const std::vector<std::string>& aov_meanings = {});

}  // namespace aureole
