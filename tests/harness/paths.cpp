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

}  // namespace aureole::test
