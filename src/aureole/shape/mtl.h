// SPDX-License-Identifier: Apache-2.0
// Materials of OBJ files: read from .mtl files and made into BSDFs.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <string>

#include "aureole/bsdf/bsdf.h"
#include "aureole/shape/mesh_file.h"

namespace aureole {

/// What is read of a material; the rest is named in `ignored`.
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
};

/// The materials of a file by name. Throws Error where it is no such file.
std::map<std::string, MtlMaterial> read_mtl(const MeshFile& file);

/// The BSDF that comes nearest; notes about what it leaves out go to `filename` of `owner`.
BsdfPtr bsdf_of_mtl(const std::string& name, const MtlMaterial& material, const Properties& owner);

}  // namespace aureole
