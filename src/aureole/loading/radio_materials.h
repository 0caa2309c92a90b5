// SPDX-License-Identifier: Apache-2.0
// Converts walls in scenes of sionna-rt to the BSDF `slab`.
#pragma once

#include "aureole/loading/node.h"

namespace aureole {

/// Converts a BSDF "itu-radio-material" with its type (concrete, ...) and thickness in metres, with a note.
/// Diffuse scattering, which `slab` does not model, is noted.
void upgrade_radio_material(Node& bsdf, Diagnostics& diagnostics);

/// Replaces BSDFs that are named after a building material, "mat-itu_concrete" or "itu_concrete", by slabs of it, 0.1 m
/// thick. Scenes of sionna-rt state their materials by these names, and their BSDFs only give colours for
/// display. BSDFs that already describe such a material are kept. One note states the number of replaced
/// BSDFs.
void replace_radio_materials(Node& root, Diagnostics& diagnostics);

}  // namespace aureole
