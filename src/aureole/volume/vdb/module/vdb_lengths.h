// SPDX-License-Identifier: Apache-2.0
// Lengths in the headers of a .vdb file, which OpenVDB believes: a damaged one makes it ask for gigabytes.
#pragma once

namespace aureole {

/// Whether all texts in the header, in the list of grids and in the grids' own headers end within the file. True
/// for files of versions before 222 (OpenVDB 1.0) and for what is no .vdb file, about which OpenVDB complains itself.
bool vdb_lengths_are_good(const char* path);

}  // namespace aureole
