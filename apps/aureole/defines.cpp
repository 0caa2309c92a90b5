// SPDX-License-Identifier: Apache-2.0
#include "aureole/core/error.h"
#include "commands.h"

namespace aureole {

std::vector<std::pair<std::string, std::string>> split_defines(const std::vector<std::string>& list) {
  std::vector<std::pair<std::string, std::string>> defines;
  for (const auto& d : list) {
    const size_t equals = d.find('=');
    if (equals == std::string::npos || equals == 0) throw Error("-D " + d + ": write -D name=value");
    defines.emplace_back(d.substr(0, equals), d.substr(equals + 1));
  }
  return defines;
}

}  // namespace aureole
