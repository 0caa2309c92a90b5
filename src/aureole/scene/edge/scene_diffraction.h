// SPDX-License-Identifier: Apache-2.0
// `SceneDiffraction`: all data of a scene for the diffraction model `beams`.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "aureole/scene/edge/lit_edges.h"
#include "aureole/scene/edge/scene_edges.h"
#include "aureole/scene/edge/seen_edges.h"
#include "aureole/scene/light_sampler.h"
#include "aureole/scene/scene_parts.h"
#include "aureole/scene/scene_surfaces.h"
#include "aureole/sensor/placed_sensor.h"

namespace aureole {

/// The parts of a scene from which edges, lights and the sensor are taken; all of them are complete.
struct DiffractionInput {
  const SceneParts& parts;
  const SceneSurfaces& surfaces;
  const std::vector<Light>& emitters;
  const LightSampler& lights;
  const PlacedSensor& sensor;
  bool has_binary_visibility;
};

class SceneDiffraction {
public:
  /// Reuses the data of another scene, `reuse`, that do not differ, unless it is null; `before` are the parts
  /// of that scene.
  SceneDiffraction(const DiffractionInput& in, const SceneDiffraction* reuse, const DiffractionInput* before);

  const SceneEdges& edges() const { return *edges_; }
  /// Returns false if no shape has edges that diffract.
  bool has_edges() const { return !edges_->empty(); }
  /// The irradiated fraction of the edges, for each light.
  const LitEdges& lit_edges() const { return *lit_; }
  /// The edges that are visible from the sensor.
  const SeenEdges& seen_edges() const { return *seen_; }
  /// Light in the scene's shadows without diffraction (scene/edge/shadow_light.h).
  float light_in_shadows() const { return light_in_shadows_; }
  /// Notes for the user.
  const std::vector<std::string>& notes() const { return notes_; }

private:
  std::shared_ptr<const SceneEdges> edges_;
  std::shared_ptr<const LitEdges> lit_;
  std::shared_ptr<const SeenEdges> seen_;
  float light_in_shadows_ = 0;
  std::vector<std::string> notes_;
};

/// Returns a note if BSDFs of the scene request diffraction and the integrator has none; else an empty text.
std::string note_without_diffraction(const SceneParts& parts);

}  // namespace aureole
