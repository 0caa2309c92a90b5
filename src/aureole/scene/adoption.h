// SPDX-License-Identifier: Apache-2.0
// A shape of an earlier build of a scene that gets other children, its geometry being the same.
#pragma once

#include <memory>

#include "aureole/scene/object_pool.h"
#include "aureole/shape/shape.h"

namespace aureole {

struct Adoption {
  std::shared_ptr<Shape> shape;
  std::shared_ptr<const Properties> properties;
  Shape::Children children;
  ObjectPool::Key key;

  /// Exchanges what the shape has with what is here: the adoption, and called again its undoing. Throws
  /// nothing.
  void exchange(ObjectPool& pool) {
    shape->exchange_children(properties, children);
    key = pool.rekey(*shape, key);
  }
};

}  // namespace aureole
