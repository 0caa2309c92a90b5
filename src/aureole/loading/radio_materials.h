// SPDX-License-Identifier: Apache-2.0
// Walls as scenes of sionna-rt describe them, converted to the BSDF `slab`.
#pragma once

#include "aureole/loading/node.h"

namespace aureole {

/// Converts a BSDF "itu-radio-material" with its type (concrete, ...) and thickness in metres, with a note. Diffuse
/// scattering, which `slab` has not, is noted.
void upgrade_radio_material(Node& bsdf, Diagnostics& diagnostics);

/// Replaces BSDFs that are named after a building material, "mat-itu_concrete" or "itu_concrete", by slabs of it, 0.1 m
/// thick. Scenes of sionna-rt state their materials by these names; the BSDFs are colours for the eye. BSDFs that are
/// made of such a material already stay. One note says how many were replaced.
void replace_radio_materials(Node& root, Diagnostics& diagnostics);

}  // namespace aureole
