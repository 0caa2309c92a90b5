// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aureole/optics/stack/plane_stack.h"

namespace aureole::optics::testing {

inline StackLayer hg_layer(double optical_thickness, double albedo, double g, double index = 1) {
  return StackLayer::of_optical_thickness(optical_thickness, albedo, LegendrePhase::henyey_greenstein(g),
                                          index);
}

/// Clear glass.
inline StackLayer slide(double index) {
  return StackLayer::of_optical_thickness(0, 0, LegendrePhase::isotropic(), index);
}

}  // namespace aureole::optics::testing
