// SPDX-License-Identifier: Apache-2.0
// The header of a .vdb file, which OpenVDB believes: damaged lengths make it ask for gigabytes.
#pragma once

#include <cstdint>
#include <string>

namespace aureole {

/// The fault in the header; empty: none. The version has to be a known one, up to `newest`, and all texts in the
/// header, in the list of grids and in the grids' own headers have to end within the file. A file that is no .vdb
/// file at all is refused by OpenVDB itself.
std::string fault_of_vdb_header(const char* path, std::uint32_t newest);

}  // namespace aureole
