// SPDX-License-Identifier: Apache-2.0
// `SensorShape`: a <shape> element as sensors use it, which nest shapes that they measure on or aim at.
#pragma once

#include "aureole/plugin/object.h"
#include "aureole/shape/shape.h"
#include "aureole/shape/shape_area.h"

namespace aureole {

class Sensor;

/// Derived from by `Asset` (asset/asset.h).
class SensorShape : public Object {
public:
  static constexpr const char* kFamily = "a shape";

  /// The sensor that sits on it, or null, and the surface that it measures on.
  const std::shared_ptr<const Sensor>& sensor() const { return sensor_; }
  const std::shared_ptr<const ShapeArea>& sensor_area() const { return sensor_area_; }
  /// The shape, where it is a single one; else null.
  virtual ShapePtr shape() const = 0;

protected:
  using Object::Object;

  std::shared_ptr<const Sensor> sensor_;
  std::shared_ptr<const ShapeArea> sensor_area_;
};

}  // namespace aureole
