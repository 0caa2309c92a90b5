// SPDX-License-Identifier: Apache-2.0
// Objects of earlier builds of a scene that the next build may keep, found by what they were made from.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "aureole/plugin/properties.h"
#include "aureole/scene/resolve.h"

namespace aureole {

class Shape;

class ObjectPool {
public:
  /// What an element and all that hangs on it say, as numbers that differ where the texts or files differ.
  struct Key {
    std::uint64_t whole = 0;
    std::uint64_t geometry = 0;  ///< of a shape: without its BSDF, emitter and sensor
  };

  /// Forgets which shapes the last build took; if spectra are tabulated on another grid, or lengths are in
  /// another unit, everything.
  void begin(const BuildContext& context);
  /// An object made from an equal element, or null. Emitters, sensors and what belongs to them depend on
  /// their scene and are never kept; a shape is given out once.
  /// `nested`: within another object, where a shape is a part of what that was built from.
  ObjectPtr whole(const std::string& family, const Key& key, bool nested);
  /// A shape of the same geometry that is not nested, or null.
  std::shared_ptr<Shape> geometry(const Key& key);
  void add(const std::string& family, const Key& key, const ObjectPtr& object, bool nested);
  /// The new key of a shape that took over children; returns the old one.
  Key rekey(const Shape& shape, const Key& key);
  bool empty() const { return objects_.empty() && shapes_.empty(); }
  /// Drops what nobody else holds.
  void trim();

private:
  struct Entry {
    Key key;
    std::shared_ptr<Shape> shape;
    bool nested = false, taken = false;
  };
  std::unordered_map<std::uint64_t, ObjectPtr> objects_;
  std::vector<Entry> shapes_;
  SpectralGrid grid_;
  double length_unit_m_ = 0;
};

/// Keys of the elements of one tree, which must not change meanwhile. Files count by path, size and time.
class PoolKeys {
public:
  explicit PoolKeys(const References& references);
  ~PoolKeys();
  ObjectPool::Key of(const Node& node);

private:
  struct Maker;
  std::unique_ptr<Maker> maker_;
};

}  // namespace aureole
