// SPDX-License-Identifier: Apache-2.0
// The available memory, and how much of it the content of a file may need.
#pragma once

#include <cstddef>
#include <string>

namespace aureole {

/// Returns the memory that this process may still allocate, in bytes: the system's available memory, or less
/// where the address space of the process is limited (`ulimit -v`).
double available_memory_bytes();

/// Memory that the content of any file may need, however small the file is.
inline constexpr double kFreeContentBytes = double(std::size_t(512) << 20);

/// Throws Error without a location if content of `bytes` bytes needs more memory than kFreeContentBytes, and more
/// than `per_byte` bytes for each byte of the file that claims it. So a small file cannot fill the memory,
/// whatever its header states and however strongly its content is compressed.
void require_content(double bytes, double file_bytes, double per_byte);

}  // namespace aureole
