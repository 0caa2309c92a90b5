// SPDX-License-Identifier: Apache-2.0
#include "harness/program.h"

#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "harness/paths.h"

namespace aureole::test {

namespace {

/// Tests read no table that the user's programs have kept, and leave none.
[[maybe_unused]] const int kWithoutCache = setenv("AUREOLE_CACHE", "off", 1);

}  // namespace

std::string file_content(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

pid_t start_program(const std::filesystem::path& folder, const std::vector<std::string>& arguments,
                    const std::filesystem::path& log, const std::function<void()>& prepare) {
  const pid_t pid = fork();
  if (pid == 0) {
    if (!folder.empty() && chdir(folder.c_str()) != 0) _exit(99);
    if (!freopen(log.c_str(), "w", stdout) || dup2(1, 2) < 0) _exit(99);
    if (prepare) prepare();
    std::vector<char*> argv{const_cast<char*>(aureole_binary().c_str())};
    for (const auto& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
    argv.push_back(nullptr);
    execv(aureole_binary().c_str(), argv.data());
    _exit(98);
  }
  return pid;
}

ProgramEnd program_end(int status, const std::filesystem::path& log) {
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), file_content(log)};
}

ProgramEnd run_program(const std::filesystem::path& folder, const std::vector<std::string>& arguments) {
  const std::filesystem::path log = folder / "log.txt";
  int status = 0;
  waitpid(start_program(folder, arguments, log), &status, 0);
  return program_end(status, log);
}

}  // namespace aureole::test
