// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>
#include <string>
#include <vector>

#include "aureole/asset/asset.h"
#include "aureole/bsdf/bsdf.h"
#include "aureole/core/error.h"
#include "aureole/loading/load.h"

namespace aureole {

/// Returns the BSDF with that id, or the BSDF of the shape with that id.
inline std::shared_ptr<const Bsdf> find_bsdf(const LoadedObjects& loaded, const std::string& file,
                                             const std::string& id) {
  std::vector<std::string> known;
  for (const auto& [its_id, object] : loaded.objects) {
    const auto asset = std::dynamic_pointer_cast<const Asset>(object);
    const bool has_parts = asset && !asset->primitives().empty();
    const auto bsdf = has_parts ? asset->primitives()[0].bsdf : std::dynamic_pointer_cast<const Bsdf>(object);
    if (!bsdf || its_id.empty()) continue;
    if (its_id == id) return bsdf;
    known.push_back(its_id);
  }
  throw Error({file, 0, 0},
              (id.empty() ? "name a BSDF or a shape after \"#\""
                          : "no BSDF or shape has the id \"" + id + "\"" + did_you_mean(id, known)) +
                  (known.empty() ? "; none of this scene has an id"
                                 : fmt::format("; there are {}", fmt::join(known, ", "))));
}

}  // namespace aureole
