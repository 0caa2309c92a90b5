// SPDX-License-Identifier: Apache-2.0
#include "scene_loading.h"

namespace aureole {

namespace {

/// The value of --cache of the one command that the process runs.
std::string& cache_choice() {
  static std::string choice;
  return choice;
}

}  // namespace

void add_cache_option(CommandOptions& options) {
  options.add("--cache", cache_choice(),
              "folder that keeps slow tables for the next start, or off (default: AUREOLE_CACHE, or "
              "~/.cache/aureole; see aureole cache)");
}

std::shared_ptr<TableCache> table_cache() {
  static const std::shared_ptr<TableCache> cache = TableCache::chosen(cache_choice());
  return cache;
}

LoadOptions load_options(const std::vector<std::string>& defines) {
  LoadOptions load;
  load.defines = split_defines(defines);
  load.tables = table_cache();
  load.check_files = keep_files_of_scene;
  return load;
}

void keep_files_of_scene(const std::vector<std::filesystem::path>& files) {
  std::vector<NamedFile> inputs;
  for (const std::filesystem::path& file : files) inputs.push_back({"a file of the scene", file});
  add_inputs(inputs);
}

}  // namespace aureole
