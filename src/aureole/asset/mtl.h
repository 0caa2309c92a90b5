// SPDX-License-Identifier: Apache-2.0
// Materials of OBJ files: reads .mtl files and converts their materials to BSDFs.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "aureole/bsdf/bsdf.h"
#include "aureole/shape/mesh/mesh_file.h"

namespace aureole {

/// A picture of a map statement, and the options that are applied.
struct MtlMap {
  std::filesystem::path file;  ///< file of the picture; empty: none
  /// scale and offset by the options -s and -o: the coordinates are scale (u, v) + offset
  std::array<double, 2> scale{1, 1}, offset{0, 0};
  bool clamp = false;  ///< whether -clamp is on

  bool operator==(const MtlMap&) const = default;
};

/// The supported statements of a material; others are listed in `ignored`.
struct MtlMaterial {
  std::array<double, 3> diffuse{0.5, 0.5, 0.5};  ///< Kd
  std::array<double, 3> specular{0, 0, 0};       ///< Ks
  bool has_specular = false;
  double exponent = 0;  ///< Ns
  double opacity = 1;   ///< opacity: d, or 1 - Tr
  double index = 0;     ///< index of refraction Ni; 0: not stated
  bool has_d = false;
  int illumination = 2;  ///< statement illum; below 2: no highlights
  MtlMap diffuse_map;    ///< map_Kd, map of the diffuse colour
  MtlMap opacity_map;    ///< map_d, map of the opacity

  /// Statements of the extension for physically based shading, with their default where none is stated.
  bool is_physical = false;                          ///< whether one of them is in the file
  double roughness = 0.5;                            ///< Pr
  double metallic = 0;                               ///< Pm
  double sheen = 0;                                  ///< Ps
  double clearcoat = 0, clearcoat_roughness = 0.03;  ///< Pc and Pcr
  double anisotropy = 0;                             ///< statement aniso
  double transmission = 0;  ///< statement Tf, in a material of the physical extension
  MtlMap roughness_map, metallic_map, sheen_map, clearcoat_map;

  std::string ignored;             ///< keywords and options, separated by commas
  std::vector<std::string> notes;  ///< notes on values that were changed

  std::array<const MtlMap*, 6> maps() const {
    return {&diffuse_map, &opacity_map, &roughness_map, &metallic_map, &sheen_map, &clearcoat_map};
  }

  bool operator==(const MtlMaterial&) const = default;
};

using MtlLibrary = std::map<std::string, MtlMaterial>;

/// Returns the materials of a file by name. Throws Error if the file is not a material library.
MtlLibrary read_mtl(const MeshFile& file);

/// Returns the BSDF closest to a material. Notes about ignored statements are located at `filename` of
/// `owner`.
BsdfPtr bsdf_of_mtl(const std::string& name, const MtlMaterial& material, const Properties& owner);

}  // namespace aureole
