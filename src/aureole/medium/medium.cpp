// SPDX-License-Identifier: Apache-2.0
#include "aureole/medium/medium.h"

#include "aureole/plugin/registry.h"

namespace aureole {

AUREOLE_FAMILY(FamilyInfo{
    .name = "medium", .fallback = "homogeneous", .hangs_on_shapes = true, .is_reusable = true});

}  // namespace aureole
