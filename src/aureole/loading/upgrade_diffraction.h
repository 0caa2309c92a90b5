// SPDX-License-Identifier: Apache-2.0
// The part of upgrading that is about scenes of Steinberg et al. 2024, "A Free-Space Diffraction BSDF".
#pragma once

#include "aureole/loading/node.h"

namespace aureole {

/// Their program has the wavelength, in units of the scene, as a parameter `wavelengths` of the integrator `bdpt`: here it becomes the
/// band of the film, and the integrator follows light around edges.
void upgrade_diffraction(Node& scene, Diagnostics& diagnostics);

}  // namespace aureole
