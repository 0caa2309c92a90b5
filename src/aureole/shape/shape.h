// SPDX-License-Identifier: Apache-2.0
// The shape family: geometry that rays meet. A shape holds no BSDF, light or sensor: `Asset` (asset/asset.h)
// associates these with it, and the scene's `Surface` records hold them.
#pragma once

#include <embree3/rtcore.h>

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "aureole/plugin/object.h"
#include "aureole/plugin/properties.h"
#include "aureole/shape/area_sampler.h"
#include "aureole/shape/instance.h"
#include "aureole/shape/mesh/mesh_attribute.h"
#include "aureole/shape/surface_point.h"

namespace aureole {

struct FileMaterials;

class Shape : public Object {
public:
  static constexpr const char* kFamily = "a shape";
  explicit Shape(const Properties& properties);

  /// An Embree geometry for this shape, committed, owned by the caller. Buffers are shared with the shape,
  /// which outlives it.
  virtual RTCGeometry make_geometry(RTCDevice device) const = 0;
  /// The surface point of an Embree hit by `ray`. Fills everything but `surface` and `instance`. Without
  /// `tangent` the shading frame may be any one around its normal; with it s lies along dp/du.
  virtual SurfacePoint surface_point(const ShapeHit& hit, const Ray& ray, bool tangent = true) const = 0;
  /// Derivatives of the position at one of its surface points, in the world, for bump and normal maps.
  SurfaceDerivatives derivatives(const SurfacePoint& point) const {
    const SurfaceDerivatives own = own_derivatives(point);
    return point.instance ? point.instance->to_world(own) : own;
  }
  /// Derivatives in the coordinates of the shape's group. `p` and the normals of a point hit through an
  /// instance are in world coordinates: only uv, primitive and barycentric may be used.
  virtual SurfaceDerivatives own_derivatives(const SurfacePoint& point) const = 0;

  /// The attribute of that name, or null. Only meshes have any.
  virtual const MeshAttribute* attribute(const AttributeName& /*name*/) const { return nullptr; }
  /// Its value at one of the shape's surface points.
  virtual Spectrum eval_attribute(const MeshAttribute& /*attribute*/, const SurfacePoint& /*point*/,
                                  const Wavelengths& /*w*/) const {
    return 0.f;
  }
  /// Why there is no such attribute, as an Error for the user.
  virtual Error no_attribute(const SourceLocation& where, const std::string& name) const;

  virtual Bounds3 bounds() const = 0;
  virtual std::size_t primitive_count() const = 0;  ///< triangles, or 1
  virtual std::size_t memory_bytes() const { return 0; }

  /// Samples points on the surface. Throws Error if the shape has no area for that use; without a location if
  /// no shape of this kind can be sampled.
  virtual std::shared_ptr<const AreaSampler> make_area_sampler(AreaUse use) const = 0;

  /// The materials that its file names; null where there are none.
  virtual std::shared_ptr<const FileMaterials> materials() const { return nullptr; }
  /// The parts of a mesh with materials: `part_of` has the part that each material belongs to, counted from
  /// 0. Parts without triangles are null.
  virtual std::vector<std::shared_ptr<const Shape>> split(std::span<const std::size_t> part_of) const;

  /// Why the surface encloses no space ("4 edges belong to one triangle alone"); empty where it does.
  virtual std::string opening() const { return {}; }

  /// Repairs made by the reader ("3 degenerate triangles dropped"), for `aureole info` and a note.
  const std::vector<std::string>& remarks() const { return remarks_; }

protected:
  /// Constructor tag for a part of a shape that has been read: reads no parameters.
  struct PartOfShape {};
  Shape(const Properties& properties, PartOfShape) : Object(properties) {}

  std::vector<std::string> remarks_;
};
using ShapePtr = std::shared_ptr<const Shape>;

}  // namespace aureole
