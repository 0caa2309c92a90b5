// SPDX-License-Identifier: Apache-2.0
// `SceneParts`: the objects of a scene, loaded from a file or made by a program. All are immutable, so that
// scenes can share them.
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
  std::vector<Primitive> surfaces;                       ///< primitives, including the emitters on them
  std::vector<std::shared_ptr<const Emitter>> emitters;  ///< emitters that are not on a shape
  std::shared_ptr<const Sensor> sensor;
  std::shared_ptr<const ShapeArea> sensor_area;  ///< area of the shape that the sensor sits on, or null
  /// The wavelengths and the unit of length with which all objects were built; never null.
  std::shared_ptr<const BuildContext> context;
  bool adds_media = false;  ///< whether the integrator adds the coefficients of media that overlap
  std::optional<DiffractionSettings> diffraction;  ///< how edges diffract light; empty: they do not
};

}  // namespace aureole
