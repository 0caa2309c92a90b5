// SPDX-License-Identifier: Apache-2.0
#include "aureole/phase/phase.h"

#include "aureole/plugin/registry.h"

namespace aureole {

AUREOLE_FAMILY(FamilyInfo{.name = "phase", .fallback = "isotropic", .is_reusable = true});

}  // namespace aureole
