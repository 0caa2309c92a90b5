// SPDX-License-Identifier: Apache-2.0
#include "aureole/ingredient/ingredient.h"

#include "aureole/plugin/registry.h"

namespace aureole {

AUREOLE_FAMILY(FamilyInfo{.name = "ingredient", .is_reusable = true});

}  // namespace aureole
