// SPDX-License-Identifier: Apache-2.0
#include "aureole/transport/ray_state.h"

#include "aureole/scene/contact_search.h"

namespace aureole {

bool RayState::is_inactive_body(const SurfacePoint& point, const Wavelengths& w) const {
  const InteriorList::Body body{point.surface, point.instance};
  if (interiors.hides(body)) return true;
  const Surface* other = interiors.filling(body).surface;
  return other && have_same_index(*other, *point.surface, w);
}

void find_interiors(const Scene& scene, const Light* light, RayState& state) {
  if (!scene.has_media()) return;
  const Medium* stated = light ? light->emitter->medium() : scene.sensor().sensor->medium();
  if (!stated) return find_interiors(scene, state);
  scene.shapes_around(state.ray, state.interiors);
  state.medium = stated;
}

void find_interiors(const Scene& scene, RayState& state) {
  scene.shapes_around(state.ray, state.interiors);
  state.contact = nullptr;
  state.medium = scene.medium_at(state.ray, state.interiors);
}

}  // namespace aureole
