// SPDX-License-Identifier: Apache-2.0
// Upgrades scenes of Steinberg et al. 2024, "A Free-Space Diffraction BSDF".
#pragma once

#include "aureole/loading/node.h"

namespace aureole {

/// Their program states the wavelength, in scene units, as the parameter `wavelengths` of the integrator
/// `bdpt`. Here it becomes the wavelength range of the film, and diffraction is enabled in the integrator.
void upgrade_diffraction(Node& scene, Diagnostics& diagnostics);

}  // namespace aureole
