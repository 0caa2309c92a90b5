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

/// Whether two names lead to one regular file, which need not exist. Devices and pipes take any number of outputs.
bool is_one_file(const std::filesystem::path& a, const std::filesystem::path& b) {
  namespace fs = std::filesystem;
  std::error_code code;
  if (a.empty() || b.empty()) return false;
  if (fs::exists(a, code) && !fs::is_regular_file(a, code)) return false;
  if (fs::equivalent(a, b, code)) return true;
  const fs::path first = fs::weakly_canonical(fs::absolute(a, code), code);
  const fs::path second = fs::weakly_canonical(fs::absolute(b, code), code);
  return !first.empty() && first == second;
}

}  // namespace

CommandRegistration::CommandRegistration(Command command) { registered().push_back(std::move(command)); }

std::vector<Command> commands() {
  std::vector<Command> sorted = registered();
  std::sort(sorted.begin(), sorted.end(), [](const Command& a, const Command& b) { return a.name < b.name; });
  return sorted;
}

void require_distinct_outputs(const std::vector<NamedFile>& outputs, const std::vector<NamedFile>& inputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const NamedFile& o = outputs[i];
    for (const NamedFile& input : inputs)
      if (is_one_file(o.file, input.file))
        throw Error(o.named_by + " " + o.file.string() + ": would replace " + input.named_by +
                    ", which is read");
    for (std::size_t j = 0; j < i; ++j)
      if (is_one_file(o.file, outputs[j].file))
        throw Error(o.named_by + " " + o.file.string() + ": is the file of " + outputs[j].named_by + ", too");
  }
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
