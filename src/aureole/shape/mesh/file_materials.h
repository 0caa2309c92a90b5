// SPDX-License-Identifier: Apache-2.0
// The materials that a mesh file names, such as an OBJ file with its .mtl files.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace aureole {

struct FileMaterials {
  /// names in the order of the triangles' material indices; the first name is empty
  std::vector<std::string> names;
  std::vector<bool> used;                        ///< whether any triangle uses the material
  std::vector<std::filesystem::path> libraries;  ///< files that define the materials
};

}  // namespace aureole
