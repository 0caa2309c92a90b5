// SPDX-License-Identifier: Apache-2.0
// Commands of the Python package, which the program starts with the words that follow their name.
#pragma once

#include <functional>
#include <string>

#include "command.h"

namespace aureole {

/// Declares a command that replaces this program by Python, running `main` of the package's module `module`. Where Python or
/// the package is missing the command ends with a sentence and exit code 2.
std::function<int()> declare_package_command(CommandOptions& options, const std::string& module);

}  // namespace aureole
