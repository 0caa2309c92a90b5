// SPDX-License-Identifier: Apache-2.0
#include "aureole/medium/medium.h"

#include "aureole/plugin/registry.h"

namespace aureole {

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
