// SPDX-License-Identifier: Apache-2.0
#include "command.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <unordered_map>

#include "aureole/core/error.h"

namespace aureole {

namespace {

std::vector<Command>& registered() {
  static std::vector<Command> list;
  return list;
}

/// A text that all names of one regular file have in common, whether or not it exists. Empty for devices and pipes, which take
/// any number of outputs.
std::string identity_of(const std::filesystem::path& file) {
  if (file.empty()) return "";
  struct stat status {};
  if (::stat(file.c_str(), &status) == 0)
    return S_ISREG(status.st_mode) ? fmt::format("{}:{}", status.st_dev, status.st_ino) : "";
  std::error_code code;
  return std::filesystem::weakly_canonical(std::filesystem::absolute(file, code), code).string();
}

/// The files of the one command that the process runs, by their identities.
struct CommandFiles {
  std::unordered_map<std::string, NamedFile> inputs, outputs;
};
CommandFiles& command_files() {
  static CommandFiles files;
  return files;
}

[[noreturn]] void refuse_replacing(const NamedFile& output, const NamedFile& input) {
  throw Error(output.named_by + " " + output.file.string() + ": would replace " + input.named_by +
              ", which is read; write to another name");
}

}  // namespace

CommandRegistration::CommandRegistration(Command command) { registered().push_back(std::move(command)); }

std::vector<Command> commands() {
  std::vector<Command> sorted = registered();
  std::sort(sorted.begin(), sorted.end(), [](const Command& a, const Command& b) { return a.name < b.name; });
  return sorted;
}

void add_outputs(const std::vector<NamedFile>& outputs) {
  CommandFiles& files = command_files();
  for (const NamedFile& output : outputs) {
    const std::string identity = identity_of(output.file);
    if (identity.empty()) continue;
    if (const auto input = files.inputs.find(identity); input != files.inputs.end())
      refuse_replacing(output, input->second);
    if (const auto [other, is_new] = files.outputs.emplace(identity, output); !is_new)
      throw Error(output.named_by + " " + output.file.string() + ": is the file of " +
                  other->second.named_by + ", too");
  }
}

void add_inputs(const std::vector<NamedFile>& inputs) {
  CommandFiles& files = command_files();
  for (const NamedFile& input : inputs) {
    const std::string identity = identity_of(input.file);
    if (identity.empty()) continue;
    if (const auto output = files.outputs.find(identity); output != files.outputs.end())
      refuse_replacing(output->second, input);
    files.inputs.emplace(identity, input);
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
