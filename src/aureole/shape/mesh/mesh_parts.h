// SPDX-License-Identifier: Apache-2.0
// Divides a mesh of several materials into several meshes.
#pragma once

#include <span>

#include "aureole/shape/mesh/mesh.h"

namespace aureole {

/// Divides a mesh: `part_of` maps each material of MeshData::materials to a part. Parts without triangles are
/// null. The data must have been built, so that shared normals stay smooth across the borders.
std::vector<ShapePtr> split_mesh(const Properties& properties, const MeshData& data,
                                 std::span<const std::size_t> part_of);

}  // namespace aureole
