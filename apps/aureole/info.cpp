// SPDX-License-Identifier: Apache-2.0
// aureole info: lists the content of a scene, a picture, a volume, splats, a radiance grid or a state file.
#include <fmt/format.h>

#include <memory>
#include <string>
#include <vector>

#include "aureole/instrument/info/file_info.h"
#include "command.h"
#include "messages.h"
#include "scene_loading.h"

namespace aureole {
namespace {

int info(const std::string& file, const std::vector<std::string>& defines) {
  const FileInfo found = file_info(file, split_defines(defines), table_cache());
  for (const std::string& note : found.notes) tell("note: {}\n", note);
  fmt::print("{}", found.text);
  return 0;
}

std::function<int()> declare(CommandOptions& options) {
  auto file = std::make_shared<std::string>();
  auto defines = std::make_shared<std::vector<std::string>>();
  options.add("file", *file, "scene, picture, volume, splats, radiance grid or .state file").required();
  options.add("-D,--define", *defines, "set a $name of the scene").takes_each_time(1);
  add_cache_option(options);
  return [=] { return info(*file, *defines); };
}

AUREOLE_COMMAND("info",
                "List the content of a scene, a picture, a volume, splats, a radiance grid or a state file",
                declare);

}  // namespace
}  // namespace aureole
