// SPDX-License-Identifier: Apache-2.0
// Open edges of meshes.
#pragma once

#include <span>
#include <string>

#include "aureole/shape/mesh/mesh.h"

namespace aureole {

/// Counts the edges that belong to an odd number of triangles, in several meshes together. Vertices at equal
/// positions count as one, so that seams of texture coordinates and normals, and borders between parts, are
/// not open edges.
std::size_t count_open_edges(std::span<const Mesh* const> meshes);

/// Returns a text such as "3 edges belong to one triangle alone", or an empty string for 0.
std::string open_edges_text(std::size_t count);

}  // namespace aureole
