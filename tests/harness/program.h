// SPDX-License-Identifier: Apache-2.0
// Starts the program as a user does, for tests of what it prints, writes and returns.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace aureole::test {

/// The end of a program: its exit code, or the number of the signal that ended it, negative; and stdout with stderr.
struct ProgramEnd {
  int exit_code = 0;
  std::string output;
};

/// The bytes of a file; none if it cannot be read.
std::string file_content(const std::filesystem::path& file);

/// Starts the program in `folder` (empty: the present one), with stdout and stderr in the file `log`. `prepare` runs in the
/// new process, after that and before the program.
pid_t start_program(const std::filesystem::path& folder, const std::vector<std::string>& arguments,
                    const std::filesystem::path& log, const std::function<void()>& prepare = {});

/// Result of a program that has ended with the status of waitpid.
ProgramEnd program_end(int status, const std::filesystem::path& log);

/// Runs the program to its end in `folder`; its output is also in the file log.txt there.
ProgramEnd run_program(const std::filesystem::path& folder, const std::vector<std::string>& arguments);

}  // namespace aureole::test
