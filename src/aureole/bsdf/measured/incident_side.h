// SPDX-License-Identifier: Apache-2.0
// Which of the two directions of a BSDF is the direction of incidence of a measured table.
#pragma once

#include "aureole/bsdf/bsdf.h"
#include "aureole/plugin/registry.h"

namespace aureole {

/// Chooses the direction that looks up a table by its direction of incidence. Tables are reciprocal but for
/// errors of measurement, so that the choice changes little. Other renderers use the view direction, from
/// which they sample; the instrument's direction of incidence is the direction of the light.
class IncidentSide {
public:
  static IncidentSide from(const Properties& p) {
    IncidentSide side;
    side.is_light_ = p.get_choice("incident", "view", {"view", "light"}) == "light";
    return side;
  }
  static ParameterDoc documentation() {
    return {
        "incident", "string", "", "view",
        "which direction is the table's direction of incidence: that of the view, as in Mitsuba and Radiance, or that of "
        "the light; without effect on reciprocal tables"};
  }
  /// Whether wo instead of wi is the table's direction of incidence. In radiance mode light arrives from wo.
  bool is_exchanged(const BsdfContext& ctx) const {
    return is_light_ == (ctx.mode == TransportMode::radiance);
  }

private:
  bool is_light_ = false;
};

}  // namespace aureole
