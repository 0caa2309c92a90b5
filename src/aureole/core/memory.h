// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace aureole {

/// Returns the memory that this process may still allocate, in bytes: what the system has available, or less
/// where the address space of the process is limited (`ulimit -v`).
double available_memory_bytes();

}  // namespace aureole
