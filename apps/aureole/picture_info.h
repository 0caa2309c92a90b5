// SPDX-License-Identifier: Apache-2.0
// Descriptions of pictures, volumes and state files, for `aureole info`.
#pragma once

#include <filesystem>

namespace aureole {

/// Prints size, format, origin, noise, colours and channels of a picture. Throws Error if it cannot be read.
void print_picture(const std::filesystem::path& file);

/// Prints size, type, spacing, position in space and range of values of a volume. Throws Error if it cannot be
/// read. Implemented in volume_info.cpp.
void print_volume(const std::filesystem::path& file);

/// Prints the picture that a state file belongs to, and how much of it is done. Throws Error if it cannot be read.
void print_state(const std::filesystem::path& file);

/// Whether a file holds splats or points, by its first bytes or its extension.
bool is_splats(const std::filesystem::path& file);
/// Prints what a file of splats holds and by which conventions. Throws Error.
void print_splats(const std::filesystem::path& file);
/// Prints size, stored voxels and range of densities of a radiance grid. Throws Error. Implemented in splat_info.cpp.
void print_radiance_voxels(const std::filesystem::path& file);

}  // namespace aureole
