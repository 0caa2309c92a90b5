// SPDX-License-Identifier: Apache-2.0
// `Primitive`: geometry with the material, media and light that belong to it, of which scenes are made.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "aureole/bsdf/bsdf.h"
#include "aureole/bssrdf/bssrdf.h"
#include "aureole/emitter/emitter.h"
#include "aureole/medium/medium.h"
#include "aureole/shape/shape.h"

namespace aureole {

/// The media at a surface: on the side of its normal and on the other. Where one of them is given, null is
/// vacuum; where none is, the same medium lies on both sides.
struct SurfaceMedia {
  MediumPtr outside, inside;
  int priority = 0;  ///< of a closed shape that may overlap others: the highest fills the space; 0: none
  BssrdfPtr bssrdf = nullptr;  ///< stands for what is inside, or null
  bool given() const { return outside || inside; }
};

/// One shape with its material and, if it shines, its emitter; or an instance, which has none of these.
struct Primitive {
  ShapePtr shape;
  BsdfPtr bsdf;
  SurfaceMedia media;
  std::shared_ptr<const Emitter> emitter;
  std::shared_ptr<const AreaSampler> area;  ///< for the emitter; null without one
  std::shared_ptr<const Instance> instance;
  /// The element it comes from, for messages; never null.
  std::shared_ptr<const Properties> element;
  std::vector<std::string> remarks;  ///< repairs made by the reader, for `aureole info` and a note
  /// The asset that it belongs to bounds a medium and has no gap.
  bool encloses_medium = false;

  Bounds3 bounds() const { return instance ? instance->bounds() : shape->bounds(); }
  std::size_t triangle_count() const;  ///< any shape that is no mesh counts as its `Shape::primitive_count`
};

/// Shapes that are instanced together, with the BSDF and the media of each.
struct ShapeList {
  std::vector<ShapePtr> shapes;
  std::vector<BsdfPtr> bsdfs;
  std::vector<SurfaceMedia> media;
  Bounds3 bounds;

  std::size_t triangle_count() const;
  std::size_t memory_bytes() const;
};

}  // namespace aureole
