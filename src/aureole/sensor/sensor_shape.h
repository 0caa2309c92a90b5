// SPDX-License-Identifier: Apache-2.0
// `SensorShape`: a <shape> element in the form that sensors need, which nest shapes that they measure on or
// aim at.
#pragma once

#include "aureole/plugin/object.h"
#include "aureole/shape/shape.h"
#include "aureole/shape/shape_area.h"

namespace aureole {

class Sensor;

/// The base class of `Asset` (asset/asset.h) that gives sensors the shape.
class SensorShape : public Object {
public:
  static constexpr const char* kFamily = "a shape";

  /// The sensor that is attached to the shape, or null, and the surface that it measures on.
  const std::shared_ptr<const Sensor>& sensor() const { return sensor_; }
  const std::shared_ptr<const ShapeArea>& sensor_area() const { return sensor_area_; }
  /// Returns the shape, if the element has a single one; else null.
  virtual ShapePtr shape() const = 0;

protected:
  using Object::Object;

  std::shared_ptr<const Sensor> sensor_;
  std::shared_ptr<const ShapeArea> sensor_area_;
};

}  // namespace aureole
