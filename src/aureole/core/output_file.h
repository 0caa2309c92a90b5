// SPDX-License-Identifier: Apache-2.0
// Writes files of the user. A file is replaced as a whole or left as it was.
#pragma once

#include <filesystem>
#include <span>

namespace aureole {

/// Replaces `file` by `bytes` atomically: writes a temporary file beside it, flushes and renames it. A symbolic
/// link is followed, also where its target does not exist yet, so that it stays a link. A character device
/// such as /dev/null is written directly. Throws Error located at `file`, also for a pipe or socket.
void write_file_atomically(const std::filesystem::path& file, std::span<const char> bytes);

/// Throws Error if a file of this name cannot be written: tries to create the temporary file that
/// `write_file_atomically` creates. Call it before spending hours on the file's content.
void require_writable(const std::filesystem::path& file);

}  // namespace aureole
