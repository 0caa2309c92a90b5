// SPDX-License-Identifier: Apache-2.0
// Notes of integrators that follow light in media.
#pragma once

#include <string>
#include <vector>

#include "aureole/medium/transport_notes.h"
#include "aureole/scene/scene.h"

namespace aureole {

/// Returns the notes of all media of a scene on how light is followed in them, for `Integrator::scene_notes`.
inline std::vector<std::string> medium_notes(const Scene& scene) {
  std::vector<std::string> all;
  for (const Medium* medium : scene.media())
    if (const auto* noting = dynamic_cast<const TransportNotes*>(medium))
      for (std::string& note : noting->transport_notes()) all.push_back(std::move(note));
  return all;
}

}  // namespace aureole
