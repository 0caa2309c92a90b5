// SPDX-License-Identifier: Apache-2.0
// Which edges go on straight beyond their ends: meshes cut them in pieces, light does not see that.
#pragma once

#include <cstdint>
#include <vector>

#include "aureole/scene/edge/edge_index.h"

namespace aureole {

class StraightEdges {
public:
  StraightEdges() = default;
  /// Edges that join at a vertex, with faces in the same planes, are one line where none of its vertices is off it by more than the
  /// rounding of coordinates.
  explicit StraightEdges(const EdgeIndex& index);

  struct Place {
    std::uint32_t line;   ///< the same for all edges of one line
    float before, after;  ///< how far that goes on beyond the edge's a and b
  };
  Place of(std::size_t edge) const {
    return places_.empty() ? Place{std::uint32_t(edge), 0, 0} : places_[edge];
  }

private:
  std::vector<Place> places_;  ///< empty where each edge is a line of its own
};

}  // namespace aureole
