// SPDX-License-Identifier: Apache-2.0
// Reads grids of .vdb and .nvdb files.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "aureole/parameter/vdb/sparse_voxels.h"

namespace aureole {

/// Reads a grid of a file of either format, distinguished by the first bytes. The default grid is "density",
/// or else the first. Throws Error without a location; `unknown_grid` is true if the file has no grid of that
/// name.
SparseVoxels read_vdb_file(const std::filesystem::path& file, const std::optional<std::string>& grid,
                           bool& unknown_grid);

/// Reads a grid of a .nvdb file.
void read_nvdb(const std::filesystem::path& file, const std::optional<std::string>& grid, SparseFile& out);

}  // namespace aureole
