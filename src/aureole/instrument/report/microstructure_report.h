// SPDX-License-Identifier: Apache-2.0
// Writes a measured microstructure: numbers, tables, plots, and a material for scenes.
#pragma once

#include <string>
#include <vector>

#include "aureole/core/image.h"
#include "aureole/instrument/microscopy/microstructure.h"
#include "aureole/instrument/report/output_folder.h"

namespace aureole {

/// Writes result.json, particles.csv, sizes.txt, structure_factor.txt, pair_correlation.txt, scene.xml, plots
/// as SVG, and for non-circular shapes apertures.svg (mean outline) and outline.svg (a typical one).
void write_microstructure(const Microstructure& m, const OutputFolder& folder);

/// A histogram of radii relative to the mean radius, in the format of `optics::SizeDistribution::histogram`:
/// mean size and count of each bin.
std::string size_histogram(const Microstructure& m);

/// The measured material as a scene file that contains it alone, and notes of what its models cannot represent.
struct MeasuredMaterial {
  std::string scene;
  std::vector<std::string> notes;
};

/// Makes a `correlated_scatterers` or `correlated_spheres` element with the measured values and the id "measured".
/// The comment before it has all choices and notes.
MeasuredMaterial measured_material(const Microstructure& m);

/// Draws the field in grey, with the outlines (green: uncut, orange: cut) and centres of its particles.
Image overlay(const Micrograph& field, const Segmentation& segmentation,
              const std::vector<Particle>& particles);

}  // namespace aureole
