// SPDX-License-Identifier: Apache-2.0
// The shape family: geometry that rays intersect. A shape has no BSDF, light or sensor: `Asset`
// (asset/asset.h) associates these with the shape, and the scene's `Surface` records store them.
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

  /// Returns a committed Embree geometry, owned by the caller. Its buffers are shared with the shape, which
  /// must outlive it.
  virtual RTCGeometry make_geometry(RTCDevice device) const = 0;
  /// Returns the surface point of an Embree hit by `ray`. Sets all members except `surface` and `instance`.
  /// With `tangent` the shading frame's s lies along dp/du; without, it may be any vector perpendicular to
  /// the normal.
  virtual SurfacePoint surface_point(const ShapeHit& hit, const Ray& ray, bool tangent = true) const = 0;
  /// Returns the derivatives of the position at a surface point, in world space, for bump and normal maps.
  SurfaceDerivatives derivatives(const SurfacePoint& point) const {
    const SurfaceDerivatives own = own_derivatives(point);
    return point.instance ? point.instance->to_world(own, point.time) : own;
  }
  /// Returns the derivatives in the coordinates of the shape's group. `p` and the normals of a point hit
  /// through an instance are in world space: only uv, primitive and barycentric may be used.
  virtual SurfaceDerivatives own_derivatives(const SurfacePoint& point) const = 0;

  /// Returns the attribute of that name, or null. Only meshes have any.
  virtual const MeshAttribute* attribute(const AttributeName& /*name*/) const { return nullptr; }
  /// Returns an attribute's value at one of the shape's surface points.
  virtual Spectrum eval_attribute(const MeshAttribute& /*attribute*/, const SurfacePoint& /*point*/,
                                  const Wavelengths& /*w*/) const {
    return 0.f;
  }
  /// Returns an Error for the user that states why the attribute does not exist.
  virtual Error no_attribute(const SourceLocation& where, const std::string& name) const;

  virtual Bounds3 bounds() const = 0;
  virtual std::size_t primitive_count() const = 0;  ///< number of triangles, or 1
  virtual std::size_t memory_bytes() const { return 0; }

  /// Makes a sampler of points on the surface. Throws Error if the shape has no area for that use; the error
  /// has no location if no shape of this kind can be sampled.
  virtual std::shared_ptr<const AreaSampler> make_area_sampler(AreaUse use) const = 0;

  /// Returns the materials that the file names; null if there are none.
  virtual std::shared_ptr<const FileMaterials> materials() const { return nullptr; }
  /// Divides a mesh with materials: `part_of` gives the part of each material, from 0. Parts without
  /// triangles are null.
  virtual std::vector<std::shared_ptr<const Shape>> split(std::span<const std::size_t> part_of) const;

  /// Returns the reason why the surface encloses no volume ("4 edges belong to one triangle alone"); empty if
  /// it encloses one.
  virtual std::string opening() const { return {}; }

  /// Returns repairs made by the reader ("3 degenerate triangles dropped"), for `aureole info` and a note.
  const std::vector<std::string>& remarks() const { return remarks_; }

protected:
  /// Constructor tag for a part of a shape that has been read already; the constructor then reads no
  /// parameters.
  struct PartOfShape {};
  Shape(const Properties& properties, PartOfShape) : Object(properties) {}

  std::vector<std::string> remarks_;
};
using ShapePtr = std::shared_ptr<const Shape>;

}  // namespace aureole
