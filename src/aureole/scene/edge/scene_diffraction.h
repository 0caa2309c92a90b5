// SPDX-License-Identifier: Apache-2.0
// `SceneDiffraction`: all that a scene keeps for edges that diffract light.
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

/// The parts of a scene that edges, lights and the sensor are found in; all of them are complete.
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
  /// Reuses what does not differ of that of another scene, `reuse`, unless it is null: `before` are its
  /// parts.
  SceneDiffraction(const DiffractionInput& in, const SceneDiffraction* reuse, const DiffractionInput* before);

  const SceneEdges& edges() const { return *edges_; }
  /// False where no shape has edges that diffract.
  bool has_edges() const { return !edges_->empty(); }
  /// The irradiated part of the edges, for each light.
  const LitEdges& lit_edges() const { return *lit_; }
  /// The edges that the sensor sees.
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

/// A note where BSDFs of the scene ask for diffraction and the integrator has none; empty: there is no such
/// BSDF.
std::string note_without_diffraction(const SceneParts& parts);

}  // namespace aureole
