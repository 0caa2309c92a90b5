// SPDX-License-Identifier: Apache-2.0
#include "command.h"

#include <algorithm>

#include "aureole/core/error.h"

namespace aureole {

namespace {

std::vector<Command>& registered() {
  static std::vector<Command> list;
  return list;
}

}  // namespace

CommandRegistration::CommandRegistration(Command command) { registered().push_back(std::move(command)); }

std::vector<Command> commands() {
  std::vector<Command> sorted = registered();
  std::sort(sorted.begin(), sorted.end(), [](const Command& a, const Command& b) { return a.name < b.name; });
  return sorted;
}

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
