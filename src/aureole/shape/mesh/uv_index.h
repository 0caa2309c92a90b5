// SPDX-License-Identifier: Apache-2.0
// Finds the triangle of a mesh that has given texture coordinates.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "aureole/math/vec.h"

namespace aureole {

/// Triangles in texture space, in a grid over [0, 1]^2.
class UvIndex {
public:
  using Triangle = std::array<Vec2, 3>;
  struct Place {
    std::uint32_t triangle;
    Vec2 barycentric;  ///< weights of the triangle's corners 1 and 2
  };

  explicit UvIndex(std::vector<Triangle> triangles);
  /// Returns the first triangle that contains the texture coordinates `uv`.
  std::optional<Place> find(Vec2 uv) const;

private:
  int cell_of(float x) const;

  std::vector<Triangle> triangles_;
  int side_ = 1;  ///< number of cells along u and along v
  /// index of each cell's first triangle in `in_cells_`, and at the end the total number
  std::vector<std::uint32_t> begin_;
  std::vector<std::uint32_t> in_cells_;
};

}  // namespace aureole
