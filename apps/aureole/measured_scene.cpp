// SPDX-License-Identifier: Apache-2.0
#include "measured_scene.h"

#include <fmt/format.h>

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

void check_sampling(const std::optional<std::int64_t>& spp, const std::optional<std::int64_t>& seed,
                    int threads) {
  if (spp && *spp < 1) throw Error(fmt::format("--spp {}: at least one sample per pixel is needed", *spp));
  if (seed && *seed < 0) throw Error(fmt::format("--seed {}: must not be negative", *seed));
  if (threads < 0 || threads > 4096)
    throw Error(fmt::format("--threads {}: must be between 1 and 4096 (0: all cores)", threads));
}

RenderOptions render_options(const std::optional<std::int64_t>& spp, const std::optional<std::int64_t>& seed,
                             int threads) {
  check_sampling(spp, seed, threads);
  RenderOptions options;
  if (spp) options.end = *spp;
  if (seed) options.seed = std::uint64_t(*seed);
  options.threads = threads;
  return options;
}

void refuse_options(std::initializer_list<std::pair<const char*, bool>> given, const std::string& reason) {
  for (const auto& [option, is_given] : given)
    if (is_given) throw Error(std::string(option) + ": " + reason);
}

void run_to_end(RenderJob& job) {
  if (job.run(stop_on_interrupt()) == RenderJob::Outcome::interrupted)
    throw Error("interrupted: nothing is written");
  if (job.state().invalid_samples > 0)
    tell("note: {} samples were invalid and left out\n", job.state().invalid_samples);
}

}  // namespace aureole
