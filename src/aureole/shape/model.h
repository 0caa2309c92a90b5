// SPDX-License-Identifier: Apache-2.0
// `Model`: the content of a <shape> element: geometry with its BSDF, emitter and sensor.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "aureole/bsdf/bsdf.h"
#include "aureole/bssrdf/bssrdf.h"
#include "aureole/emitter/emitter.h"
#include "aureole/medium/medium.h"
#include "aureole/plugin/registry.h"
#include "aureole/sensor/sensor.h"
#include "aureole/shape/mesh/mtl.h"
#include "aureole/shape/shape.h"
#include "aureole/shape/shape_area.h"

namespace aureole {

/// The media on both sides of a surface. If one of them is given, null is vacuum; if none is, one medium lies
/// on both sides.
struct SurfaceMedia {
  MediumPtr outside, inside;
  int priority = 0;  ///< of a closed shape that may overlap others: the highest priority fills the volume; 0:
                     ///< none
  BssrdfPtr bssrdf = nullptr;  ///< replaces the medium inside; may be null
  bool given() const { return outside || inside; }
};

/// The part of a model with one shape or one instance.
struct ModelPart {
  // One shape with its material and its emitter, if any; or an instance, which has neither.
  ShapePtr shape;
  BsdfPtr bsdf;
  SurfaceMedia media;
  std::shared_ptr<const Emitter> emitter;
  std::shared_ptr<const AreaSampler> area;  ///< for the emitter; null without one
  std::shared_ptr<const Instance> instance;
  /// The scene element that defines it, for messages; never null.
  std::shared_ptr<const Properties> element;
  std::vector<std::string> remarks;  ///< repairs made by the reader, for `aureole info` and a note
  /// Whether its model bounds a medium and has no gap.
  bool encloses_medium = false;

  Bounds3 bounds() const { return instance ? instance->bounds() : shape->bounds(); }
  std::size_t primitive_count() const;
};

/// Shapes that are instanced together, with the BSDF and the media of each.
struct ShapeList {
  std::vector<ShapePtr> shapes;
  std::vector<BsdfPtr> bsdfs;
  std::vector<SurfaceMedia> media;
  Bounds3 bounds;

  std::size_t primitive_count() const;
  std::size_t memory_bytes() const;
};

class Model : public Object {
public:
  static constexpr const char* kFamily = "a shape";

  const std::vector<ModelPart>& parts() const { return parts_; }
  /// The sensor attached to the model, or null, and the surface on which it measures.
  const std::shared_ptr<const Sensor>& sensor() const { return sensor_; }
  const std::shared_ptr<const ShapeArea>& sensor_area() const { return sensor_area_; }
  /// Returns the shape if there is only one; else null.
  ShapePtr shape() const { return parts_.size() == 1 ? parts_[0].shape : nullptr; }

protected:
  using Object::Object;

  std::vector<ModelPart> parts_;
  std::shared_ptr<const Sensor> sensor_;
  std::shared_ptr<const ShapeArea> sensor_area_;
};

/// The parts of a mesh whose file names materials.
struct MeshParts {
  std::shared_ptr<const FileMaterials> materials;
  std::vector<std::size_t> part_of;  ///< index of the part of each material
  std::vector<ShapePtr> shapes;      ///< null if no triangle has such a material
  std::vector<std::string> remarks;  ///< notes on the whole mesh
};

/// Creates the geometry of models, or returns geometry kept from an earlier build (loading/object_pool.h).
class GeometrySource {
public:
  virtual ~GeometrySource() = default;
  /// Returns a `Shape`, or a `Model` of a plug-in without its own geometry (groups and instances).
  virtual ObjectPtr geometry(const PluginInfo& plugin, const Properties& properties) {
    return plugin.create(properties);
  }
  /// Returns the parts kept for equal geometry; null: none.
  virtual std::shared_ptr<const MeshParts> parts(const Properties& /*geometry*/) { return nullptr; }
  virtual void keep(const Properties& /*geometry*/, const std::shared_ptr<const MeshParts>& /*parts*/) {}
  virtual std::shared_ptr<const AreaSampler> area_sampler(const ShapePtr& shape, AreaUse use) {
    return shape->make_area_sampler(use);
  }
  /// Returns the BSDF of a material of the file's libraries.
  virtual BsdfPtr material(const Properties& geometry, const std::string& name, const MtlMaterial& material) {
    return bsdf_of_mtl(name, material, geometry);
  }
};

/// Returns the model of an element with these parameters. Throws located Errors.
std::shared_ptr<Model> make_model(const PluginInfo& plugin, const Properties& element,
                                  GeometrySource& source);

/// Returns the object of an element: a `Model` if the plug-in is a shape.
ObjectPtr make_element(const PluginInfo& plugin, const Properties& element);

}  // namespace aureole
