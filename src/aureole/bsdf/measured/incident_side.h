// SPDX-License-Identifier: Apache-2.0
// Which of the two directions of a BSDF is the direction of incidence of a measured table.
#pragma once

#include "aureole/bsdf/bsdf.h"
#include "aureole/plugin/registry.h"

namespace aureole {

/// Measured tables are reciprocal but for errors of measurement, so that it matters little. Other renderers take the
/// direction of view, from which they sample; the instrument's is the direction of the light.
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
  /// Whether the table's direction of incidence is wo, not wi. In radiance mode light arrives from wo.
  bool is_exchanged(const BsdfContext& ctx) const {
    return is_light_ == (ctx.mode == TransportMode::radiance);
  }

private:
  bool is_light_ = false;
};

}  // namespace aureole
