// SPDX-License-Identifier: Apache-2.0
// Straight lines of several edges: meshes cut straight edges into pieces, which diffract as one.
#pragma once

#include <cstdint>
#include <vector>

#include "aureole/scene/edge/edge_index.h"

namespace aureole {

class StraightEdges {
public:
  StraightEdges() = default;
  /// Finds the lines. Edges that join at a vertex, with faces in the same planes, are one line if none of its
  /// vertices is off the line by more than the rounding of coordinates.
  explicit StraightEdges(const EdgeIndex& index);

  struct Place {
    std::uint32_t line;   ///< equal for all edges of one line
    float before, after;  ///< lengths of the line beyond the edge's a and b
  };
  Place of(std::size_t edge) const {
    return places_.empty() ? Place{std::uint32_t(edge), 0, 0} : places_[edge];
  }

private:
  std::vector<Place> places_;  ///< empty if each edge is a line of its own
};

}  // namespace aureole
