// SPDX-License-Identifier: Apache-2.0
// The reader of .vdb files is a module of its own (libaureole_vdb.so), which is loaded by the first such file:
// linked with the program, OpenVDB's library of 57 MB would add 45 ms to each of its starts.
#pragma once

#include "aureole/volume/vdb/sparse_voxels.h"

namespace aureole {

/// Reads a grid of a .vdb file; `grid` null: the default one. Does not throw.
using ReadVdb = void(const char* file, const char* grid, SparseFile& out);

inline constexpr const char* kVdbModuleFile = "libaureole_vdb.so";
inline constexpr const char* kVdbModuleFunction = "aureole_read_vdb";

}  // namespace aureole
