// SPDX-License-Identifier: Apache-2.0
// A mesh of several materials as several meshes.
#pragma once

#include <span>

#include "aureole/shape/mesh.h"

namespace aureole {

/// One mesh for every BSDF among `bsdfs`, which MeshData::materials counts; equal ones share a mesh. The data
/// has been built: shared normals stay smooth across the borders.
std::vector<ShapePtr> split_mesh(const Properties& properties, const MeshData& data,
                                 std::span<const BsdfPtr> bsdfs, std::vector<std::string> remarks);

}  // namespace aureole
