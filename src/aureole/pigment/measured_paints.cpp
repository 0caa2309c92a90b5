// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/measured_paints.h"

#include <sstream>

extern "C" const char aureole_kimera_data[];

namespace aureole::pigment {

const SampleTable& kimera_samples() {
  static const SampleTable table = [] {
    std::istringstream text(aureole_kimera_data);
    return read_samples(text);
  }();
  return table;
}

Surface kimera_surface() { return smooth_surface(1.5, Geometry::angle_45_0, Specular::excluded); }

const Fit& kimera_fit() {
  static const Fit result = fit(kimera_samples(), {.surface = kimera_surface()});
  return result;
}

}  // namespace aureole::pigment
