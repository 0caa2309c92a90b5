// SPDX-License-Identifier: Apache-2.0
// `Primitive`: geometry with its material, media and emitter. Scenes are made of primitives.
#pragma once

#include <algorithm>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "aureole/bsdf/bsdf.h"
#include "aureole/bssrdf/bssrdf.h"
#include "aureole/emitter/emitter.h"
#include "aureole/medium/medium.h"
#include "aureole/shape/shape.h"

namespace aureole {

/// The media on the side of a surface's normal (`outside`) and on the other (`inside`). If one of them is
/// given, null is vacuum; if none is given, the same medium is on both sides.
struct SurfaceMedia {
  MediumPtr outside, inside;
  int priority = 0;            ///< priority of a nested dielectric: the highest fills an overlap; 0: none
  BssrdfPtr bssrdf = nullptr;  ///< subsurface scattering in place of a medium inside, or null
  bool given() const { return outside || inside; }
};

/// A shape with its material and, if it emits, its emitter; or an instance, which has none of these.
struct Primitive {
  ShapePtr shape;
  BsdfPtr bsdf;
  SurfaceMedia media;
  std::shared_ptr<const Emitter> emitter;
  std::shared_ptr<const AreaSampler> area;  ///< sampler of the area for the emitter; null without one
  std::shared_ptr<const Instance> instance;
  /// For an instance: the media of the group's shapes, placed with the instance (asset/placed_media.h). Empty
  /// if the group's own media apply.
  std::vector<SurfaceMedia> placed_media;
  /// The element that the primitive comes from, for messages; never null.
  std::shared_ptr<const Properties> element;
  std::vector<std::string> remarks;  ///< repairs made by the reader, for `aureole info` and a note
  /// Whether the asset that the primitive belongs to bounds a medium and has no gap.
  bool encloses_medium = false;
  /// Whether the asset has several parts, of which this is one, that have no gap together. `Shape::opening` says
  /// it for an asset of one shape.
  bool is_part_of_closed = false;

  /// Returns the media of the shapes of an instance's group.
  std::span<const SurfaceMedia> member_media() const;
  Bounds3 bounds() const { return instance ? instance->bounds() : shape->bounds(); }
  /// Number of triangles; a shape that is not a mesh counts with `Shape::primitive_count`.
  std::size_t triangle_count() const;
};

/// Shapes that are instanced together, with the BSDF and the media of each.
struct ShapeList {
  std::vector<ShapePtr> shapes;
  std::vector<BsdfPtr> bsdfs;
  std::vector<SurfaceMedia> media;
  std::vector<std::shared_ptr<const Properties>> elements;  ///< the element that each shape comes from
  std::vector<std::shared_ptr<const Emitter>> emitters;     ///< the emitter of each shape, or null
  std::vector<std::shared_ptr<const AreaSampler>>
      areas;                            ///< the area sampler of each shape that emits, or null
  std::vector<bool> is_part_of_closed;  ///< the flag of each shape, as in `Primitive`
  Bounds3 bounds;

  /// Whether a shape emits.
  bool shines() const {
    return std::any_of(emitters.begin(), emitters.end(),
                       [](const auto& emitter) { return emitter != nullptr; });
  }
  std::size_t triangle_count() const;
  std::size_t memory_bytes() const;
};

}  // namespace aureole
