// SPDX-License-Identifier: Apache-2.0
// `Asset`: the content of a <shape> element: geometry with its BSDF, emitter and sensor.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "aureole/asset/mtl.h"
#include "aureole/asset/primitive.h"
#include "aureole/plugin/registry.h"
#include "aureole/sensor/sensor.h"
#include "aureole/sensor/sensor_shape.h"

namespace aureole {

class Asset : public SensorShape {
public:
  const std::vector<Primitive>& primitives() const { return primitives_; }
  /// Notes about the position of an asset that belongs to the scene itself and not to a group.
  const std::vector<std::string>& placement_notes() const { return placement_notes_; }
  ShapePtr shape() const override { return primitives_.size() == 1 ? primitives_[0].shape : nullptr; }

protected:
  using SensorShape::SensorShape;

  std::vector<Primitive> primitives_;
  std::vector<std::string> placement_notes_;
};

/// The parts of a mesh whose file names materials.
struct MeshParts {
  std::shared_ptr<const FileMaterials> materials;
  std::vector<std::size_t> part_of;  ///< part index of each material
  std::vector<ShapePtr> shapes;      ///< geometry of each part; null if the part has no triangle
  std::vector<std::string> remarks;  ///< notes about the whole mesh
};

/// Makes the geometry of assets, or returns geometry kept from an earlier build (loading/object_pool.h).
class GeometrySource {
public:
  virtual ~GeometrySource() = default;
  /// Returns a `Shape`, or an `Asset` if the plug-in has no geometry of its own (groups and instances).
  virtual ObjectPtr geometry(const PluginInfo& plugin, const Properties& properties) {
    return plugin.create(properties);
  }
  /// Returns the parts that were kept for equal geometry parameters, or null.
  virtual std::shared_ptr<const MeshParts> parts(const Properties& /*geometry*/) { return nullptr; }
  virtual void keep(const Properties& /*geometry*/, const std::shared_ptr<const MeshParts>& /*parts*/) {}
  virtual std::shared_ptr<const AreaSampler> area_sampler(const ShapePtr& shape, AreaUse use) {
    return shape->make_area_sampler(use);
  }
  /// Returns the BSDF of a material in the file's libraries.
  virtual BsdfPtr material(const Properties& geometry, const std::string& name, const MtlMaterial& material) {
    return bsdf_of_mtl(name, material, geometry);
  }
};

/// Returns the asset of an element with these parameters. Throws located Errors.
std::shared_ptr<Asset> make_asset(const PluginInfo& plugin, const Properties& element,
                                  GeometrySource& source);

/// Returns the object of an element: an `Asset` if the plug-in is a shape.
ObjectPtr make_element(const PluginInfo& plugin, const Properties& element);

}  // namespace aureole
