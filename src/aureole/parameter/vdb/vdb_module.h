// SPDX-License-Identifier: Apache-2.0
// The reader of .vdb files is a separate module (libaureole_vdb.so), loaded for the first such file. Linked
// with the program, OpenVDB's library of 57 MB would add 45 ms to each start.
#pragma once

#include "aureole/parameter/vdb/sparse_voxels.h"

namespace aureole {

/// Reads a grid of a .vdb file; `grid` null: the default one. Does not throw.
using ReadVdb = void(const char* file, const char* grid, SparseFile& out);

inline constexpr const char* kVdbModuleFile = "libaureole_vdb.so";
inline constexpr const char* kVdbModuleFunction = "aureole_read_vdb";

}  // namespace aureole
