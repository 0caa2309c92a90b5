// SPDX-License-Identifier: Apache-2.0
// Ctrl-C for subcommands that stop at the first one.
#pragma once

#include <atomic>

namespace aureole {

/// Installs a handler of SIGINT and returns the flag that it sets.
const std::atomic<bool>& stop_on_interrupt();

/// Whether a SIGINT has arrived since `stop_on_interrupt`.
bool is_interrupted();

}  // namespace aureole
