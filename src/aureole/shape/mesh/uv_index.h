// SPDX-License-Identifier: Apache-2.0
// Which triangle of a mesh has given texture coordinates.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "aureole/math/vec.h"

namespace aureole {

/// Triangles in the plane of texture coordinates, in a grid over [0, 1]^2.
class UvIndex {
public:
  using Triangle = std::array<Vec2, 3>;
  struct Place {
    std::uint32_t triangle;
    Vec2 barycentric;  ///< weights of its corners 1 and 2
  };

  explicit UvIndex(std::vector<Triangle> triangles);
  /// The first triangle that holds the point.
  std::optional<Place> find(Vec2 uv) const;

private:
  int cell_of(float x) const;

  std::vector<Triangle> triangles_;
  int side_ = 1;                      ///< cells along u and v
  std::vector<std::uint32_t> begin_;  ///< of each cell's triangles in `in_cells_`, and the end of all
  std::vector<std::uint32_t> in_cells_;
};

}  // namespace aureole
