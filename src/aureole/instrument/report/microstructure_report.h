// SPDX-License-Identifier: Apache-2.0
// Writes a measured microstructure: numbers, tables, plots, and a material for scenes.
#pragma once

#include <string>

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

/// A `correlated_scatterers` element with the measured values.
std::string scene_snippet(const Microstructure& m);

/// Draws the field in grey, with the outlines (green: uncut, orange: cut) and centres of its particles.
Image overlay(const Micrograph& field, const Segmentation& segmentation,
              const std::vector<Particle>& particles);

}  // namespace aureole
