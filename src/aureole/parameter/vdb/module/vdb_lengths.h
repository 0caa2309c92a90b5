// SPDX-License-Identifier: Apache-2.0
// Checks the header of a .vdb file. OpenVDB does not: damaged lengths make it allocate gigabytes.
#pragma once

#include <cstdint>
#include <string>

namespace aureole {

/// Returns the fault in the header; empty: none. The version must be known, up to `newest`. All texts in the
/// header, in the list of grids and in the grids' own headers must end within the file. OpenVDB itself
/// rejects a file of another format.
std::string fault_of_vdb_header(const char* path, std::uint32_t newest);

}  // namespace aureole
