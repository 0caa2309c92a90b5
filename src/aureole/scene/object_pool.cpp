// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/object_pool.h"

#include <algorithm>
#include <utility>

#include "aureole/shape/shape.h"

namespace aureole {

namespace {

bool keeps(const std::string& family) {
  return family == "bsdf" || family == "texture" || family == "aperture" || family == "correlation";
}

}  // namespace

void ObjectPool::begin(const BuildContext& context) {
  if (!(context.grid == grid_) || context.length_unit_m != length_unit_m_) objects_.clear(), shapes_.clear();
  grid_ = context.grid, length_unit_m_ = context.length_unit_m;
  for (Entry& e : shapes_) e.taken = false;
}

ObjectPtr ObjectPool::whole(const std::string& family, const Key& key, bool nested) {
  if (keeps(family)) {
    const auto found = objects_.find(key.whole);
    return found == objects_.end() ? nullptr : found->second;
  }
  if (family != "shape") return nullptr;
  for (Entry& e : shapes_)
    if (!e.taken && e.nested == nested && e.key.whole == key.whole && !e.shape->emitter() &&
        !e.shape->sensor()) {
      e.taken = true;
      return e.shape;
    }
  return nullptr;
}

std::shared_ptr<Shape> ObjectPool::geometry(const Key& key) {
  Entry* best = nullptr;
  for (Entry& e : shapes_)
    if (!e.taken && !e.nested && e.key.geometry == key.geometry && (!best || e.key.whole == key.whole))
      best = &e;
  if (!best) return nullptr;
  best->taken = true;
  return best->shape;
}

void ObjectPool::add(const std::string& family, const Key& key, const ObjectPtr& object, bool nested) {
  if (keeps(family)) objects_.emplace(key.whole, object);
  if (family != "shape") return;
  if (const auto shape = std::dynamic_pointer_cast<Shape>(object))
    shapes_.push_back({key, shape, nested, true});
}

ObjectPool::Key ObjectPool::rekey(const Shape& shape, const Key& key) {
  for (Entry& e : shapes_)
    if (e.shape.get() == &shape) return std::exchange(e.key, key);
  return key;
}

void ObjectPool::trim() {
  std::erase_if(shapes_, [](const Entry& e) { return e.shape.use_count() == 1; });
  // An object may be held by another one of the pool alone.
  while (std::erase_if(objects_, [](const auto& e) { return e.second.use_count() == 1; }) > 0) {
  }
}

}  // namespace aureole
