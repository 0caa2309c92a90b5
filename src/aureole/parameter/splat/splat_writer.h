// SPDX-License-Identifier: Apache-2.0
// Writes files of splats.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "aureole/parameter/splat/splat_cloud.h"

namespace aureole {

/// Extensions that `write_splat_file` knows: ".ply", ".spz", ".glb", ".usda".
const std::vector<std::string>& splat_extensions();

/// Writes a cloud in the conventions of the format that the extension names: PLY of 3D Gaussian splatting, or of points for a
/// cloud of points; .spz of version 3; glTF with KHR_gaussian_splatting; text of OpenUSD. Replaces the file as a whole. Returns notes on what
/// the format does not hold, with counts. Throws Error located at the file.
std::vector<std::string> write_splat_file(const std::filesystem::path& file, const SplatCloud& cloud);

}  // namespace aureole
