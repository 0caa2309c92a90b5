// SPDX-License-Identifier: Apache-2.0
// `SceneParts`: the objects that a scene is made of, from a file or from a program. All are immutable, so
// that scenes may share them.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "aureole/asset/primitive.h"
#include "aureole/plugin/properties.h"
#include "aureole/scene/edge/beam_width.h"
#include "aureole/sensor/sensor.h"
#include "aureole/shape/shape_area.h"

namespace aureole {

struct SceneParts {
  std::vector<Primitive> surfaces;                       ///< with the emitters that sit on them
  std::vector<std::shared_ptr<const Emitter>> emitters;  ///< emitters without a shape
  std::shared_ptr<const Sensor> sensor;
  std::shared_ptr<const ShapeArea> sensor_area;  ///< of the shape that the sensor sits on, or null
  /// The wavelengths and unit of length that all objects were built with; never null.
  std::shared_ptr<const BuildContext> context;
  /// Edges diffract light in beams of that width; nothing: they do not.
  std::optional<BeamWidth> diffraction;
};

}  // namespace aureole
