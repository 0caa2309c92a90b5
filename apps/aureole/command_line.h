// SPDX-License-Identifier: Apache-2.0
// The program `aureole` as a function: for its main() and for the Python module, which brings the command.
#pragma once

namespace aureole {

/// Runs the command line. Returns the exit code: 0 done, 1 interrupted or a comparison that fails, 2 wrong
/// input. Never throws.
int run_command_line(int argc, char** argv);

}  // namespace aureole
