// SPDX-License-Identifier: Apache-2.0
// A mesh of several materials as several meshes.
#pragma once

#include <span>

#include "aureole/shape/mesh/mesh.h"

namespace aureole {

/// Divides a mesh: `part_of` maps each material of MeshData::materials to a part. Parts without triangles are
/// null. Takes data that has been built, so that shared normals stay smooth across the borders.
std::vector<ShapePtr> split_mesh(const Properties& properties, const MeshData& data,
                                 std::span<const std::size_t> part_of);

}  // namespace aureole
