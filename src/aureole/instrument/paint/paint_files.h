// SPDX-License-Identifier: Apache-2.0
// Files of measured paints and of palettes. What is wrong in one is an Error with the file and the line and
// column, or the key.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "aureole/parameter/palette_file.h"
#include "aureole/pigment/fit.h"
#include "aureole/pigment/match.h"

namespace aureole {

/// Reads measured samples: comma-separated values (pigment/samples.h); CGATS (pigment/cgats_text.h), by the ending
/// .cgats or by the word BEGIN_DATA_FORMAT; CxF (cxf_file.h), by the ending .cxf or since it begins with '<'; or JSON where the name
/// ends with .json:
///     {"unit": "fraction" or "percent", "wavelengths_nm": [...],
///      "samples": [{"sample": ..., "paints": {"red": 0.1, "white": 0.9}, "quantity": "R", "backing": "opaque",
///                   "thickness_um": 20, "values": [...]}, ...]}
/// where `paints` may also be a recipe as text, and all but `paints` and `values` may be missing; or the
/// array of the repository PaintMixing (wavelengths, then samples in per cent). `kimera` is the table of the
/// library.
pigment::SampleTable read_sample_file(const std::string& file);

/// `pigment::fit`, with errors located in the file.
pigment::Fit fit_file(const std::string& file, const pigment::SampleTable& table,
                      const pigment::FitSettings& settings);

/// The paints of a recipe that are in it.
std::vector<pigment::Component> components_of(const pigment::Palette& palette,
                                              const std::vector<double>& fractions);

/// A palette's pigments with K, S and their errors.
nlohmann::json palette_json(const pigment::Palette& palette);

}  // namespace aureole
