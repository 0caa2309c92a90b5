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
  ShapePtr shape() const override { return primitives_.size() == 1 ? primitives_[0].shape : nullptr; }

protected:
  using SensorShape::SensorShape;

  std::vector<Primitive> primitives_;
};

/// The parts of a mesh whose file names materials.
struct MeshParts {
  std::shared_ptr<const FileMaterials> materials;
  std::vector<std::size_t> part_of;  ///< the part that each material belongs to
  std::vector<ShapePtr> shapes;      ///< null where no triangle has such a material
  std::vector<std::string> remarks;  ///< of the whole mesh
};

/// Makes the geometry of assets, or returns geometry kept from an earlier build (loading/object_pool.h).
class GeometrySource {
public:
  virtual ~GeometrySource() = default;
  /// A `Shape`, or an `Asset` of a plug-in that is no geometry of its own (groups and instances).
  virtual ObjectPtr geometry(const PluginInfo& plugin, const Properties& properties) {
    return plugin.create(properties);
  }
  /// The parts that were kept for the same geometry; null: none.
  virtual std::shared_ptr<const MeshParts> parts(const Properties& /*geometry*/) { return nullptr; }
  virtual void keep(const Properties& /*geometry*/, const std::shared_ptr<const MeshParts>& /*parts*/) {}
  virtual std::shared_ptr<const AreaSampler> area_sampler(const ShapePtr& shape, AreaUse use) {
    return shape->make_area_sampler(use);
  }
  /// The BSDF of a material of the file's libraries.
  virtual BsdfPtr material(const Properties& geometry, const std::string& name, const MtlMaterial& material) {
    return bsdf_of_mtl(name, material, geometry);
  }
};

/// The asset that an element with these parameters stands for. Throws located Errors.
std::shared_ptr<Asset> make_asset(const PluginInfo& plugin, const Properties& element,
                                  GeometrySource& source);

/// The object that an element stands for: an `Asset` where the plug-in is a shape.
ObjectPtr make_element(const PluginInfo& plugin, const Properties& element);

}  // namespace aureole
