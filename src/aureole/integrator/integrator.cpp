// SPDX-License-Identifier: Apache-2.0
#include "aureole/integrator/integrator.h"

#include "aureole/plugin/registry.h"

namespace aureole {

AUREOLE_FAMILY(FamilyInfo{.name = "integrator", .fallback = "path"});

}  // namespace aureole
