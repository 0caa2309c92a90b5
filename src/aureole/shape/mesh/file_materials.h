// SPDX-License-Identifier: Apache-2.0
// The materials that a mesh's file names, such as an OBJ file with its .mtl files.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace aureole {

struct FileMaterials {
  std::vector<std::string> names;                ///< as triangles count them; the first has none
  std::vector<bool> used;                        ///< by any triangle
  std::vector<std::filesystem::path> libraries;  ///< files that say what the materials are
};

}  // namespace aureole
