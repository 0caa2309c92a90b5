// SPDX-License-Identifier: Apache-2.0
// The files of a measured microstructure: numbers, tables, plots, a material.
#pragma once

#include <string>

#include "aureole/core/image.h"
#include "aureole/instrument/microscopy/microstructure.h"
#include "aureole/instrument/report/output_folder.h"

namespace aureole {

/// result.json, particles.csv, sizes.txt, structure_factor.txt, pair_correlation.txt, scene.xml, plots as
/// SVG, and for shapes that are not round apertures.svg (mean outline) and outline.svg (a typical one).
void write_microstructure(const Microstructure& m, const OutputFolder& folder);

/// A histogram of radii relative to the mean radius, as `optics::SizeDistribution::histogram` reads it:
/// mean size and count of each bin.
std::string size_histogram(const Microstructure& m);

/// A `correlated_scatterers` element with the measured numbers.
std::string scene_snippet(const Microstructure& m);

/// The field in grey with the outlines (green whole, orange cut) and centres of its particles.
Image overlay(const Micrograph& field, const Segmentation& segmentation,
              const std::vector<Particle>& particles);

}  // namespace aureole
