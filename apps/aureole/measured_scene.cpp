// SPDX-License-Identifier: Apache-2.0
#include "measured_scene.h"

#include "aureole/core/error.h"
#include "interruption.h"
#include "messages.h"
#include "scene_loading.h"

namespace aureole {

LoadedScene load_measured_scene(const std::string& file, const std::vector<std::string>& defines,
                                bool is_quiet) {
  LoadedScene loaded = load_scene(file, load_options(defines));
  if (!is_quiet)
    for (const auto& note : loaded.notes) tell("note: {}\n", note);
  return loaded;
}

RenderOptions render_options(std::int64_t spp, std::int64_t seed, int threads) {
  RenderOptions options;
  if (spp > 0) options.end = spp;
  if (seed >= 0) options.seed = std::uint64_t(seed);
  options.threads = threads;
  return options;
}

void run_to_end(RenderJob& job) {
  if (job.run(stop_on_interrupt()) == RenderJob::Outcome::interrupted)
    throw Error("interrupted: nothing is written");
  if (job.state().invalid_samples > 0)
    tell("note: {} samples were invalid and left out\n", job.state().invalid_samples);
}

}  // namespace aureole
