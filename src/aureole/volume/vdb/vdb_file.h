// SPDX-License-Identifier: Apache-2.0
// Grids of .vdb and .nvdb files.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "aureole/volume/vdb/sparse_voxels.h"

namespace aureole {

/// A grid of a file of either format, told apart by their first bytes. Without a name: "density" or else the
/// first. Throws Error without a location; `unknown_grid` is true where the file has no grid of that name.
SparseVoxels read_vdb_file(const std::filesystem::path& file, const std::optional<std::string>& grid,
                           bool& unknown_grid);

/// The same for a .nvdb file.
void read_nvdb(const std::filesystem::path& file, const std::optional<std::string>& grid, SparseFile& out);

}  // namespace aureole
