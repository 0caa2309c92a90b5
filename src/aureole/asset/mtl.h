// SPDX-License-Identifier: Apache-2.0
// Materials of OBJ files: reads .mtl files and converts their materials to BSDFs.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <string>

#include "aureole/bsdf/bsdf.h"
#include "aureole/shape/mesh/mesh_file.h"

namespace aureole {

/// The supported statements of a material; others are listed in `ignored`.
struct MtlMaterial {
  std::array<double, 3> diffuse{0.5, 0.5, 0.5};  ///< Kd
  std::array<double, 3> specular{0, 0, 0};       ///< Ks
  double exponent = 0;                           ///< Ns
  double opacity = 1;                            ///< d, or 1 - Tr
  bool has_d = false;
  int illumination = 2;               ///< illum; below 2: no highlights
  std::filesystem::path diffuse_map;  ///< map_Kd; empty: none
  std::filesystem::path opacity_map;  ///< map_d
  std::string ignored;                ///< keywords, separated by commas

  bool operator==(const MtlMaterial&) const = default;
};

using MtlLibrary = std::map<std::string, MtlMaterial>;

/// Returns the materials of a file by name. Throws Error if the file is not a material library.
MtlLibrary read_mtl(const MeshFile& file);

/// Returns the closest BSDF. Notes about ignored statements are located at `filename` of `owner`.
BsdfPtr bsdf_of_mtl(const std::string& name, const MtlMaterial& material, const Properties& owner);

}  // namespace aureole
