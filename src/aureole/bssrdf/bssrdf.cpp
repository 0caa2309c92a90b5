// SPDX-License-Identifier: Apache-2.0
#include "aureole/bssrdf/bssrdf.h"

#include "aureole/bssrdf/boundary/boundary.h"
#include "aureole/plugin/registry.h"

namespace aureole {

Bssrdf::Bssrdf(const Properties& properties) : Object(properties) {
  Boundary made = make_boundary(properties);
  relative_index_ = std::move(made.relative_index);
  boundary_ = std::move(made.entry), exit_ = std::move(made.exit);
}

AUREOLE_FAMILY(FamilyInfo{
    .name = "bssrdf",
    .second_element = "subsurface",
    .parameters =
        {{"bsdf", "bsdf", "", "a smooth boundary with int_ior and ext_ior",
          "the boundary, in place of int_ior and ext_ior: a `dielectric` or a `roughdielectric` without "
          "spatial variation"},
         {"int_ior", "float or string", "", "polypropylene",
          "index of refraction inside, as a number or the name of a material"},
         {"ext_ior", "float or string", "", "air",
          "index of refraction outside, as a number or the name of a material"},
         {"dispersion", "boolean", "", "true", "named materials use their dispersion data if available"}},
    .belongs_to_shapes = true,
    .is_reusable = true});

}  // namespace aureole
