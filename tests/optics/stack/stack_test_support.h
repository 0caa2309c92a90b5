// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <random>

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

inline StackDescription stack_of(std::vector<StackLayer> layers) {
  StackDescription d;
  d.layers = std::move(layers);
  return d;
}

/// Two layers of different index on a third one, absorbing or not.
inline StackDescription refractive_stack(bool absorbing, int seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<> u(0, 1);
  StackDescription d;
  for (const double n : {1.5, 1.33, 1.7})
    d.layers.push_back(
        hg_layer(0.2 + 3 * u(random), absorbing ? 0.5 + 0.5 * u(random) : 1, 1.6 * u(random) - 0.8, n));
  d.index_below = 1.2;
  return d;
}

}  // namespace aureole::optics::testing
