// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/edge/scene_diffraction.h"

#include <algorithm>

#include "aureole/scene/edge/diffracting_shapes.h"
#include "aureole/scene/edge/open_ways.h"
#include "aureole/scene/edge/shadow_light.h"

namespace aureole {

namespace {

template <class Same>
bool all_same(const SceneParts& a, const SceneParts& b, const Same& same) {
  return std::equal(a.surfaces.begin(), a.surfaces.end(), b.surfaces.begin(), b.surfaces.end(), same);
}

bool has_same_edges(const DiffractionInput& in, const DiffractionInput& before) {
  return before.surfaces.tracer == in.surfaces.tracer && before.parts.diffraction == in.parts.diffraction &&
         all_same(in.parts, before.parts, [](const Primitive& a, const Primitive& b) {
           return a.shape == b.shape && a.bsdf == b.bsdf && a.instance == b.instance;
         });
}

bool has_same_lights(const DiffractionInput& in, const DiffractionInput& before) {
  return before.parts.emitters == in.parts.emitters &&
         all_same(in.parts, before.parts,
                  [](const Primitive& a, const Primitive& b) { return a.emitter == b.emitter; });
}

bool has_same_sensor(const DiffractionInput& in, const DiffractionInput& before) {
  return in.parts.sensor == before.parts.sensor && in.parts.sensor_area == before.parts.sensor_area;
}

}  // namespace

SceneDiffraction::SceneDiffraction(const DiffractionInput& in, const SceneDiffraction* reuse,
                                   const DiffractionInput* before) {
  const bool same_edges = reuse && has_same_edges(in, *before),
             same_lights = same_edges && has_same_lights(in, *before);
  edges_ =
      same_edges ? reuse->edges_ : std::make_shared<const SceneEdges>(in.parts, in.parts.diffraction->width);
  if (edges_->empty()) notes_.push_back(kNoDiffractingEdges);
  notes_.insert(notes_.end(), edges_->notes().begin(), edges_->notes().end());
  const SpectralGrid& grid = in.parts.context->grid;
  const Wavelengths middle = Wavelengths::at(grid, Spectrum(float(0.5 * (grid.min_nm + grid.max_nm))));
  if (same_lights)
    lit_ = reuse->lit_;
  else if (!in.has_binary_visibility)
    lit_ = std::make_shared<const LitEdges>();  // visibility rays have no transmittance
  else
    lit_ = std::make_shared<const LitEdges>(*edges_, *in.surfaces.tracer, in.emitters, in.lights, middle);
  seen_ = same_lights && has_same_sensor(in, *before)
              ? reuse->seen_
              : std::make_shared<const SeenEdges>(*edges_, *in.surfaces.tracer, in.emitters, *lit_, in.sensor,
                                                  middle);
  if (edges_->empty()) return;
  light_in_shadows_ = aureole::light_in_shadows(in, *edges_, *lit_, middle);
  if (std::string note = note_on_slits(in.surfaces, *edges_); !note.empty())
    notes_.push_back(std::move(note));
}

std::string note_without_diffraction(const SceneParts& parts) {
  const Bsdf* bsdf = first_diffracting_bsdf(parts);
  if (!bsdf) return {};
  const std::string where = bsdf->properties().where().str();
  return (where.empty() ? "" : where + ": ") + "edges of \"" + bsdf->properties().type() +
         "\" do not diffract light here: the integrator has no \"diffraction\", or it is off";
}

}  // namespace aureole
