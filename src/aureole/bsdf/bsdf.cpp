// SPDX-License-Identifier: Apache-2.0
#include "aureole/bsdf/bsdf.h"

#include "aureole/plugin/registry.h"

namespace aureole {

AUREOLE_FAMILY(FamilyInfo{
    .name = "bsdf", .fallback = "diffuse", .belongs_to_shapes = true, .is_reusable = true});

}  // namespace aureole
