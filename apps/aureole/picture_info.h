// SPDX-License-Identifier: Apache-2.0
// Descriptions of pictures, volumes and state files, for `aureole info`.
#pragma once

#include <filesystem>

namespace aureole {

/// Prints size, format, origin, noise, colours and channels of a picture. Throws Error if the file cannot be
/// read.
void print_picture(const std::filesystem::path& file);

/// Prints size, type, spacing, position in space and range of values of a volume. Throws Error if it cannot be
/// read. Implemented in volume_info.cpp.
void print_volume(const std::filesystem::path& file);

/// Prints the picture to which a state file belongs, and the fraction of it that is done. Throws Error if the
/// file cannot be read.
void print_state(const std::filesystem::path& file);

/// Whether a file holds splats or points, by its first bytes or its extension.
bool is_splats(const std::filesystem::path& file);
/// Prints the content of a file of splats, and its conventions. Throws Error.
void print_splats(const std::filesystem::path& file);

}  // namespace aureole
