// SPDX-License-Identifier: Apache-2.0
#include "aureole/asset/primitive.h"

namespace aureole {

std::size_t Primitive::triangle_count() const {
  return instance ? instance->list().triangle_count() : shape->primitive_count();
}

std::span<const SurfaceMedia> Primitive::member_media() const {
  return placed_media.empty() ? instance->list().media : placed_media;
}

std::size_t ShapeList::triangle_count() const {
  std::size_t sum = 0;
  for (const ShapePtr& s : shapes) sum += s->primitive_count();
  return sum;
}

std::size_t ShapeList::memory_bytes() const {
  std::size_t sum = sizeof(*this);
  for (const ShapePtr& s : shapes) sum += s->memory_bytes();
  return sum;
}

}  // namespace aureole
