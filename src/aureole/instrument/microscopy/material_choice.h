// SPDX-License-Identifier: Apache-2.0
// The material that a microstructure is written as: what its scatterers are, and where the models of the material do not
// describe the particles. Used by microstructure.cpp only.
#pragma once

#include "aureole/instrument/microscopy/microstructure.h"

namespace aureole {

/// Throws Error, which names the option, if the index of refraction is missing, unknown or without use.
void check_material_options(const MicrostructureOptions& options);

/// Sets `scatterer` and `int_ior` from the options and, if they leave the choice, from the polarity. Adds each choice
/// to `choices`. Throws Error if fields disagree in polarity and no kind is given.
void choose_scatterers(Microstructure& m, const MicrostructureOptions& options);

/// Notes where measured positions, distances or sizes differ from those of the material's models by more than their
/// errors: the structure factor of equal hard discs, the onset of g(r), and the log-normal sizes of spheres.
void note_bad_fits(Microstructure& m);

}  // namespace aureole
