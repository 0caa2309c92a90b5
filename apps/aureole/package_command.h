// SPDX-License-Identifier: Apache-2.0
// Commands of the Python package, which the program starts with the words that follow their name.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "command.h"

namespace aureole {

/// Declares a command that replaces this program by Python, running `main` of the package's module `module`. Where Python or
/// the package is missing the command ends with a sentence and exit code 2.
std::function<int()> declare_package_command(CommandOptions& options, const std::string& module);

/// Runs `main` of a module of the Python package with these words in another process, and returns its exit code: 2 where
/// the package is missing, after a sentence on standard error. Throws Error if there is no Python.
int run_in_package(const std::string& module, const std::vector<std::string>& words);

}  // namespace aureole
