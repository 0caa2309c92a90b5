// SPDX-License-Identifier: Apache-2.0
// The command `aureole pigment` as tests run it: in a folder of their own, with its messages.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "harness/paths.h"
#include "loading/load_text.h"

namespace aureole::test {

class PigmentCli : public ::testing::Test {
protected:
  /// Runs `aureole pigment ARGUMENTS` by the shell in the test's folder; its output is in `said`.
  int run(const std::string& arguments) {
    const std::filesystem::path log = folder.path / "log.txt";
    const int status = std::system(("cd '" + folder.path.string() + "' && '" + aureole_binary().string() +
                                    "' pigment " + arguments + " > '" + log.string() + "' 2>&1")
                                       .c_str());
    std::ifstream in(log);
    said.assign(std::istreambuf_iterator<char>(in), {});
    return WEXITSTATUS(status);
  }
  void write(const std::string& name, const std::string& text) { std::ofstream(folder.path / name) << text; }
  /// The recipes in a report of `match`, by value, so that they outlive the report.
  nlohmann::json solutions(const std::string& name) { return json(name).at("solutions"); }
  nlohmann::json json(const std::string& name) {
    std::ifstream in(folder.path / name);
    return nlohmann::json::parse(in);
  }
  void fails(const std::string& arguments, const std::string& message) {
    EXPECT_EQ(run(arguments), 2) << arguments;
    EXPECT_NE(said.find(message), std::string::npos) << arguments << "\n" << said;
  }

  TemporaryFolder folder;
  std::string said;
};

/// The text with the first occurrence of `old` replaced.
inline std::string replaced(std::string text, const std::string& old, const std::string& by) {
  const auto at = text.find(old);
  EXPECT_NE(at, text.npos) << old;
  return at == text.npos ? text : text.replace(at, old.size(), by);
}

}  // namespace aureole::test
