// SPDX-License-Identifier: Apache-2.0
// Parts of scenes with plane layers. The slabs lie between horizontal squares; between mirrors all around, or
// where the squares are wide enough, they are infinite.
#pragma once

#include <string>

#include "harness/effort.h"
#include "medium/scene_text.h"

namespace aureole::testing {

using test::is_thorough;

/// A square of half width `half` at the height z, facing up or down.
inline std::string level(double z, bool up, const std::string& content, double half = 1) {
  const std::string size = std::to_string(half);
  return "<shape type=\"rectangle\"><transform name=\"to_world\"><scale x=\"" + size + "\" y=\"" + size +
         "\"/>" + std::string(up ? "" : "<rotate x=\"1\" angle=\"180\"/>") + "<translate z=\"" +
         std::to_string(z) + "\"/></transform>" + content + "</shape>";
}

/// Four mirrors around the squares of half width 1, from below to above.
inline std::string mirrors() {
  std::string all;
  for (const char* turn : {"0", "90", "180", "270"})
    all +=
        "<shape type=\"rectangle\"><bsdf type=\"twosided\"><bsdf type=\"conductor\"><string "
        "name=\"material\" value=\"none\"/></bsdf></bsdf><transform name=\"to_world\"><scale x=\"1\" "
        "y=\"3\"/><rotate x=\"1\" angle=\"90\"/><translate y=\"1\"/><rotate z=\"1\" angle=\"" +
        std::string(turn) + "\"/></transform></shape>";
  return all;
}

}  // namespace aureole::testing
