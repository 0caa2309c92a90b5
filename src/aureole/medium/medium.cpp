// SPDX-License-Identifier: Apache-2.0
#include "aureole/medium/medium.h"

#include "aureole/plugin/registry.h"

namespace aureole {

PhaseFunctionPtr only_phase(const Properties& p) {
  const auto phases = p.get_children<PhaseFunction>("phase");
  if (phases.size() > 1)
    throw Error(p.where(), "\"" + p.type() + "\" has " + std::to_string(phases.size()) +
                               " phase functions; a medium has one (\"blendphase\" mixes two)");
  return phases.empty() ? make_default<PhaseFunction>(p, "phase") : phases.front();
}

MediumPtr only_medium(const Properties& properties) {
  const auto media = properties.get_children<Medium>("medium");
  if (media.size() > 1)
    throw Error(media[1]->properties().where(),
                "\"" + properties.type() + "\" is in one medium, but has " + std::to_string(media.size()));
  return media.empty() ? nullptr : media[0];
}

AUREOLE_FAMILY(FamilyInfo{
    .name = "medium", .fallback = "homogeneous", .belongs_to_shapes = true, .is_reusable = true});

}  // namespace aureole
