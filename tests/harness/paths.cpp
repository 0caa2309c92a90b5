// SPDX-License-Identifier: Apache-2.0
#include "harness/paths.h"

namespace aureole::test {

const std::filesystem::path& source_dir() {
  static const std::filesystem::path path = AUREOLE_SOURCE_DIR;
  return path;
}

const std::filesystem::path& aureole_binary() {
  static const std::filesystem::path path = AUREOLE_BINARY;
  return path;
}

std::filesystem::path example_file(const std::string& name) {
  const std::filesystem::path wanted = name;
  if (const auto measured = source_dir() / "tests/bsdf/data/measured" / wanted;
      std::filesystem::exists(measured))
    return measured;
  std::filesystem::path found;
  for (const char* folder : {"tests/references/scenes", "tests/volume/data/heads"}) {
    if (!found.empty()) break;
    for (const auto& e : std::filesystem::recursive_directory_iterator(source_dir() / folder)) {
      if (e.path().filename() == wanted.filename()) return e.path();
      if (e.path().extension() == wanted.extension()) found = e.path();
    }
  }
  return found.empty() ? wanted : found;
}

}  // namespace aureole::test
