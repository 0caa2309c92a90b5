// SPDX-License-Identifier: Apache-2.0
// What a scene finds out about its media as a whole: which of them are lights, and whether the one that its
// sensor is in is closed.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "aureole/scene/emitting_media.h"
#include "aureole/scene/scene.h"

namespace aureole {

void Scene::find_emitting_media(const SampledSpectrum& response, std::vector<SampledSpectrum>& powers) {
  if (!any_medium_emits_) return;
  // What each emitting medium fills, by the surfaces that it lies within: a box for each closed one, one box
  // around all where some are flat and close a volume together.
  std::vector<std::pair<const Medium*, std::vector<Bounds3>>> found;
  const auto add = [&](const MediumPtr& medium, const Bounds3& box) {
    if (!medium || !medium->emits()) return;
    auto at =
        std::find_if(found.begin(), found.end(), [&](const auto& f) { return f.first == medium.get(); });
    if (at == found.end()) at = found.insert(found.end(), {medium.get(), {}});
    at->second.push_back(box);
  };
  for (const ModelPart& part : parts_.surfaces) {
    if (!part.instance) {
      add(part.media.inside, part.bounds());
      continue;
    }
    for (const SurfaceMedia& media : part.instance->list().media) add(media.inside, part.bounds());
  }
  std::vector<EmittingMedia::Filled> filled;
  for (auto& [medium, boxes] : found) {
    const auto is_flat = [](const Bounds3& b) {
      const Vec3 d = b.diagonal();
      return !(d.x > 0 && d.y > 0 && d.z > 0);
    };
    if (medium->majorants() || std::any_of(boxes.begin(), boxes.end(), is_flat)) {
      for (const Bounds3& b : boxes) boxes[0].extend(b);
      boxes.resize(1);
    }
    for (const Bounds3& b : boxes) filled.push_back({medium, b});
  }
  auto media = std::make_shared<EmittingMedia>(filled, response);
  if (media->empty()) return;
  powers.insert(powers.end(), media->powers().begin(), media->powers().end());
  emitting_media_ = std::move(media);
}

void Scene::check_sensor_medium() const {
  if (sensor_.sensor->medium() || media_bounds_.empty()) return;
  const Ray view =
      sensor_
          .sample_ray({sensor_.part.left + 0.5f * sensor_.part.width, 0.5f * sensor_.part.height},
                      {0.5f, 0.5f})
          .ray;
  // Directions all around, along a spiral, so that they avoid the edges of boxes.
  constexpr int kDirections = 16, kLeaks = 2;
  const Surface* within = nullptr;
  int leaks = 0;
  Vec3 leak;
  for (int i = 0; i < kDirections; ++i) {
    const float z = 1 - (2 * float(i) + 1) / kDirections, r = std::sqrt(1 - z * z),
                turn = 2.3999632f * float(i);
    Ray next{view.o, {r * std::cos(turn), r * std::sin(turn), z}, kInfinity};
    for (;;) {
      const auto point = intersect(next);
      if (!point) {
        ++leaks, leak = next.d;
        break;
      }
      const Surface& surface = *point->surface;
      if (surface.bounds_media && surface.priority == 0) {
        if (surface.inside && dot(next.d, point->ng) > 0) within = &surface;
        break;
      }
      if (!surface.passable) break;
      next.o = offset_origin(*point, next.d);
    }
  }
  // One ray may slip through between two triangles.
  if (within && leaks >= kLeaks)
    throw Error(sensor_.properties().where(),
                fmt::format("the sensor is in the medium within \"{}\", which is not closed: from there one "
                            "sees out along ({:.2g}, {:.2g}, {:.2g}) without meeting a surface. Close it, or "
                            "say by a <ref> to a medium in the sensor which one it is in",
                            within->shape->properties().type(), leak.x, leak.y, leak.z));
}

}  // namespace aureole
