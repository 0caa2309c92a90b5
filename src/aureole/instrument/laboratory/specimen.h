// SPDX-License-Identifier: Apache-2.0
// Specimens, which lie on an instrument of the laboratory: a surface or a sheet with its BSDF, or a slab of a medium.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "aureole/bsdf/bsdf.h"
#include "aureole/bssrdf/bssrdf.h"
#include "aureole/loading/load.h"
#include "aureole/medium/medium.h"

namespace aureole {

struct Specimen {
  std::string name = {};
  BsdfPtr bsdf = {};         ///< null: that of `element`
  MediumPtr medium = {};     ///< inside a slab, or null
  BssrdfPtr bssrdf = {};     ///< of a slab, or null
  double thickness_m = 0;    ///< of a slab [m]; 0: a surface without depth
  std::string element = {};  ///< a <bsdf> as XML, for standards

  bool is_slab() const { return thickness_m > 0; }
  /// Whether the surface of a slab refracts light and scatters none: rays that pass it have one direction.
  bool is_refracting() const;
  /// Whether light may pass: a slab, or a BSDF that transmits.
  bool is_translucent() const;
  /// The index of refraction, relative to the outside and in the middle of the grid, of the body behind a surface that is no slab; 1: none.
  double index_behind(const SpectralGrid& grid) const;
};

/// A specimen with the grid of wavelengths and the unit of length of its scene, which an instrument takes over.
struct LoadedSpecimen {
  Specimen specimen;
  SpectralGrid grid;
  double length_unit_m = 1;
  std::vector<std::string> notes;
};

/// The BSDF of that id in a scene, or the BSDF of the shape of that id, with its interior medium, its BSSRDF or its index of
/// refraction as a slab. `thickness_m` is that of the slab; 0: the smallest extent of the shape's bounding box. Throws Error, located at the
/// file, where there is no such id, and for a thickness of a surface without depth.
LoadedSpecimen load_specimen(const std::filesystem::path& file, const std::string& id,
                             const LoadOptions& options, double thickness_m);

/// The specimen of a text scene.xml#id. Throws Error also where it has no id.
LoadedSpecimen load_specimen_called(const std::string& target, const LoadOptions& options,
                                    double thickness_m);

/// A Lambertian standard of this reflectance.
Specimen lambertian_standard(double reflectance);
/// Black glass of this index of refraction, for gloss.
Specimen black_glass(double ior);
/// No sample at all: an open port.
Specimen open_port();

/// The shapes of a specimen whose surface is the local plane z = 0, as the content of a scene.
struct SpecimenPlace {
  std::string matrix;  ///< 16 numbers, row by row: specimen to world
  double radius = 1;   ///< half of a side of its square [scene units]
  double length_unit_m = 1;
  std::string key = "sample";  ///< a prefix of the keys of objects in `given`
};
std::string specimen_shape(const Specimen& specimen, const SpecimenPlace& place,
                           std::map<std::string, ObjectPtr>& given);

}  // namespace aureole
