// SPDX-License-Identifier: Apache-2.0
#include "aureole/transport/ray_state.h"

namespace aureole {

void find_interiors(const Scene& scene, const Light* light, RayState& state) {
  if (!scene.has_media()) return;
  const Medium* stated = light ? light->emitter->medium() : scene.sensor().sensor->medium();
  if (!stated) return find_interiors(scene, state);
  scene.shapes_around(state.ray, state.interiors);
  state.medium = stated;
}

void find_interiors(const Scene& scene, RayState& state) {
  scene.shapes_around(state.ray, state.interiors);
  const InteriorList::Body filling = state.interiors.filling();
  state.contact = nullptr;
  state.medium = medium_across({}, filling, nullptr);
  if (!filling.surface || (filling.surface->rank < 0 && !filling.surface->bounds_media))
    state.medium = scene.medium_at(state.ray);
}

}  // namespace aureole
