// SPDX-License-Identifier: Apache-2.0
// The program `aureole` as a function, for its main() and for the Python module, which installs the command.
#pragma once

namespace aureole {

/// Runs the command line. Returns the exit code: 0 success, 1 interrupted or a failed comparison, 2 invalid
/// input. Never throws.
int run_command_line(int argc, char** argv);

}  // namespace aureole
