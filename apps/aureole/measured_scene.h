// SPDX-License-Identifier: Apache-2.0
// Scenes that subcommands render as a whole in order to measure in the picture.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "aureole/loading/load.h"
#include "aureole/render/job.h"

namespace aureole {

/// Loads a scene with the values of its $names, written NAME=VALUE, and prints its notes unless `is_quiet`. Throws Error.
LoadedScene load_measured_scene(const std::string& file, const std::vector<std::string>& defines,
                                bool is_quiet);

/// Options of a job by the options of a command: -1 samples per pixel or seed stand for those of the scene, 0 threads for all.
RenderOptions render_options(std::int64_t spp, std::int64_t seed, int threads);

/// Runs a job to its end and prints how many samples were invalid. Throws Error where the user interrupts it.
void run_to_end(RenderJob& job);

}  // namespace aureole
