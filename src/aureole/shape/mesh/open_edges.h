// SPDX-License-Identifier: Apache-2.0
// Gaps of meshes.
#pragma once

#include <span>
#include <string>

#include "aureole/shape/mesh/mesh.h"

namespace aureole {

/// The edges that an odd number of triangles share, of several meshes together. Vertices at one position are one:
/// seams of texture coordinates and normals are no gaps, nor are borders between parts of a mesh.
std::size_t count_open_edges(std::span<const Mesh* const> meshes);

/// "3 edges belong to one triangle alone", or an empty string for 0.
std::string open_edges_text(std::size_t count);

}  // namespace aureole
