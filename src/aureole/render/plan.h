// SPDX-License-Identifier: Apache-2.0
// A job before its first unit: options, checks of them, and the empty state that the job fills.
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
  std::optional<AdaptiveTarget> adaptive;  ///< default: the sampler's
  int threads = 0;                         ///< 0: all cores
  int replicates = 1;                      ///< independently scrambled renders, for variances
  double time_limit_s = 0;  ///< 0: none; else ends after the first whole block that every pixel has
  double checkpoint_interval_s = 30;
  std::filesystem::path state_file;  ///< empty: no checkpoints
  bool keep_state = false;           ///< keep the state file of a finished job
};

/// The state of a picture without samples. Throws Error for: a sample range that cuts blocks, a film too
/// large for memory, a filter that is too wide, no integrator, adaptive sampling of paths that belong to no
/// pixel.
RenderState planned_state(const LoadedScene& loaded, const RenderOptions& options);

/// The film's linear map from measured values to channels, as matrices; `aovs` are stored unchanged.
Development development_of(const Film& film, const std::vector<std::string>& aovs = {});

}  // namespace aureole
