// SPDX-License-Identifier: Apache-2.0
// Ctrl-C for subcommands that stop at the first one and write nothing.
#pragma once

#include <atomic>

namespace aureole {

/// Installs a handler of SIGINT and returns the flag that it sets.
const std::atomic<bool>& stop_on_interrupt();

}  // namespace aureole
