// SPDX-License-Identifier: Apache-2.0
// Readers of the formats of radiance grids, for `read_radiance_voxels`.
#pragma once

#include <filesystem>

#include "aureole/parameter/radiance/radiance_voxels.h"

namespace aureole::radiance_reader {

/// Whether a file begins like one of OpenVDB or NanoVDB. Throws Error if it cannot be read.
bool is_vdb(const std::filesystem::path& file);

/// Reads the grid "density" and the colours of a file of OpenVDB or NanoVDB: vectors "sh_0", "sh_1", ... are the coefficients of
/// the harmonics, else the vectors "color" or "Cd" a linear colour. Throws Error located at the file.
RadianceVoxels read_vdb(const std::filesystem::path& file);

/// Empties stored voxels whose numbers are not finite or are no colours (`kMostHarmonic`), with notes that count them.
void empty_bad_voxels(RadianceVoxels& voxels);

}  // namespace aureole::radiance_reader
