// SPDX-License-Identifier: Apache-2.0
// Scenes that subcommands render as a whole in order to measure in the picture.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "aureole/loading/load.h"
#include "aureole/render/job.h"
#include "command.h"

namespace aureole {

/// Loads a scene with the values of its $names, written NAME=VALUE, and prints its notes unless `is_quiet`. Throws Error.
LoadedScene load_measured_scene(const std::string& file, const std::vector<std::string>& defines,
                                bool is_quiet);

/// Throws Error for values of --spp, --seed and --threads that no job takes; commands call it before they load a scene.
void check_sampling(const std::optional<std::int64_t>& spp, const std::optional<std::int64_t>& seed,
                    int threads);

/// Options of a job by the options of a command: without samples per pixel or a seed those of the scene, with 0 threads all
/// cores. Throws Error as `check_sampling` does.
RenderOptions render_options(const std::optional<std::int64_t>& spp, const std::optional<std::int64_t>& seed,
                             int threads);

/// Throws Error for the first option that is given, with the reason why it does not apply to the command's target.
void refuse_options(std::initializer_list<std::pair<const char*, bool>> given, const std::string& reason);

/// Runs a job to its end and prints how many samples were invalid. Throws Error where the user interrupts it.
void run_to_end(RenderJob& job);

}  // namespace aureole
