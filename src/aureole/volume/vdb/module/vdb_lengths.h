// SPDX-License-Identifier: Apache-2.0
// The header of a .vdb file, which OpenVDB believes: damaged lengths make it ask for gigabytes.
#pragma once

#include <cstdint>
#include <string>

namespace aureole {

/// What is wrong with the header; empty: nothing. Its version is one that is known, up to `newest`, and all texts in
/// it, in the list of grids and in the grids' own headers end within the file. Of what is no .vdb file at all OpenVDB
/// complains itself.
std::string fault_of_vdb_header(const char* path, std::uint32_t newest);

}  // namespace aureole
