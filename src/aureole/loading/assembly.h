// SPDX-License-Identifier: Apache-2.0
// Sorts the objects of a scene into shapes, lights, sensor and integrator.
#pragma once

#include <unordered_set>

#include "aureole/loading/builder.h"
#include "aureole/loading/references.h"
#include "aureole/scene/scene_parts.h"

namespace aureole {

/// Collects the children of <scene>, built in their order.
class SceneAssembly {
public:
  SceneAssembly(Builder& builder, const References& references, Diagnostics& diagnostics)
      : builder_(builder), references_(references), diagnostics_(diagnostics) {}

  /// Builds the children of `root`. A missing sensor is an error only if it is needed and the whole file could be
  /// read.
  void run(const Node& root, bool needs_sensor);

  SceneParts parts;  ///< parts of the scene, without a context
  ObjectPtr integrator;

private:
  void add(const Node& child);
  void keep(const Node& node, const std::string& family, const ObjectPtr& object);
  /// Uses the sensor on a shape as the scene's sensor.
  void take_sensor(const Node& node, const Asset& asset);
  /// Adds the asset's surfaces, instances and lights to the scene.
  void append_primitives(const Node& node, const Asset& asset);

  Builder& builder_;
  const References& references_;
  Diagnostics& diagnostics_;
  const Node *sensor_ = nullptr, *integrator_ = nullptr;
  bool shape_failed_ = false;
  /// objects that were added: an element is added once, however often it is referenced
  std::unordered_set<const Object*> appended_;
};

}  // namespace aureole
