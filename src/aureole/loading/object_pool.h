// SPDX-License-Identifier: Apache-2.0
// Objects of earlier builds of a scene, which the next build may reuse, keyed by a hash of their inputs.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "aureole/asset/asset.h"
#include "aureole/core/word_hash.h"
#include "aureole/loading/references.h"
#include "aureole/plugin/properties.h"

namespace aureole {

class ObjectPool {
public:
  /// Tables shared by all builds.
  const std::shared_ptr<ModelCache>& models() const { return models_; }

  /// Begins a build: marks all geometry as unused. Empties the pool if the spectral grid, the unit of
  /// length or the scene's `energy_preserving` has changed.
  void begin(const BuildContext& context);
  /// Whether objects of a family are kept as a whole. For shapes only the geometry is kept
  /// (`geometry_source`).
  static bool keeps(const std::string& family);
  /// Returns an object made from an equal element (`PoolKeys::of`), or null.
  ObjectPtr find(std::uint64_t key) const;
  void add(std::uint64_t key, const ObjectPtr& object) { objects_.emplace(key, object); }
  /// Returns a source of the kept geometry of the shape with that key (`PoolKeys::geometry_of`); if there is none, it
  /// makes the geometry and keeps it. It must not be used after the next `begin`.
  std::unique_ptr<GeometrySource> geometry_source(std::uint64_t key);
  bool empty() const { return objects_.empty() && shapes_.empty(); }
  /// Releases objects to which nothing outside the pool refers.
  void trim();

private:
  class Source;
  /// The BSDF made from a material of an .mtl file, with that material and the state of its files.
  struct Material {
    MtlMaterial made_of;
    std::vector<std::uint64_t> files;
    BsdfPtr bsdf;
  };
  /// Geometry of one element, with its parts and samplers. It is used at most once per build, because two
  /// shapes of a scene never share one geometry.
  struct Entry {
    std::vector<std::string> attributes;
    ShapePtr shape;                                  ///< the shape; null if the mesh was divided
    std::shared_ptr<const MeshParts> parts;          ///< the parts of a divided mesh
    std::shared_ptr<const AreaSampler> samplers[2];  ///< indexed by AreaUse
    std::unordered_map<std::string, Material> materials;
    bool taken = true;

    bool is_unused() const;
  };
  /// Geometries of equal elements.
  struct EqualShapes {
    std::vector<std::unique_ptr<Entry>> entries;
    std::size_t taken = 0;  ///< number of entries taken in this build, which come first
  };
  Entry& add_entry(std::uint64_t key, const std::vector<std::string>& attributes);

  std::unordered_map<std::uint64_t, ObjectPtr> objects_;
  std::unordered_map<std::uint64_t, EqualShapes> shapes_;  ///< shapes by `PoolKeys::geometry_of`
  std::shared_ptr<ModelCache> models_ = std::make_shared<ModelCache>();
  SpectralGrid grid_;
  double length_unit_m_ = 0;
  std::optional<bool> energy_preserving_;
};

/// Keys of the elements of one tree, which must not change meanwhile. Files are represented by path, size and
/// time.
class PoolKeys {
public:
  /// `given` maps keys to the objects made by the program.
  PoolKeys(const References& references, const std::map<std::string, ObjectPtr>& given);
  ~PoolKeys();
  /// Hash of an element and of everything below it, including the files that it names.
  std::uint64_t of(const Node& node);
  /// Hash of a shape's element without its BSDF, emitter and sensor.
  std::uint64_t geometry_of(const Node& node);
  /// Hash of an object's inputs: of its element without its name and ids, and of the settings of the scene.
  std::uint64_t content_of(const Node& node, const BuildContext& context);
  /// Hash of an object's inputs for tables that are kept on disc: as `content_of`, but with the content of files. Nothing
  /// where the program has made one of the objects below. Throws Error for a file that cannot be read.
  std::optional<WideHashValue> inputs_of(const Node& node, const BuildContext& context);

private:
  struct Maker;
  std::unique_ptr<Maker> maker_;
};

}  // namespace aureole
