// SPDX-License-Identifier: Apache-2.0
// Files of measured paints and of palettes. Problems are Errors with the file and either line and column or
// the JSON path.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "aureole/parameter/palette_file.h"
#include "aureole/pigment/fit.h"
#include "aureole/pigment/match.h"

namespace aureole {

/// Reads measured samples, in one of these formats: comma-separated values (pigment/samples.h); CGATS
/// (pigment/cgats_text.h), with the extension .cgats or containing the word BEGIN_DATA_FORMAT; CxF
/// (cxf_file.h), with the extension .cxf or beginning with '<'; or, with the extension .json, JSON of the
/// form
///     {"unit": "fraction" or "percent", "wavelengths_nm": [...],
///      "samples": [{"sample": ..., "paints": {"red": 0.1, "white": 0.9}, "quantity": "R",
///                   "backing": "opaque", "thickness_um": 20, "values": [...]}, ...]}
/// where `paints` may also be a recipe as text, and all but `paints` and `values` are optional. JSON may also
/// be the array of the repository PaintMixing (wavelengths, then samples in per cent). The name `kimera`
/// reads the built-in table of the library. If `recipes` are optional, tables of text need no column of paints.
pigment::SampleTable read_sample_file(const std::string& file,
                                      pigment::Recipes recipes = pigment::Recipes::required);

/// Joins files of measured samples to one table, at the wavelengths of the first that all of them have; others are
/// interpolated as `pigment::interpolated` does. Cards and specimens belong to their file: where several
/// files have a bare card of one name, each has a card of its own, and layers without a specimen are
/// different layers in different files. Throws Error if wavelengths do not overlap or instruments differ.
pigment::SampleTable read_sample_files(const std::vector<std::string>& files);

/// Throws an Error with the location in the file of an error about a table that was read from it.
[[noreturn]] void rethrow_located(const std::string& file, const pigment::SampleTable& table,
                                  const std::domain_error& error);

/// Calls f(), which uses the table, and adds the location in the file to its errors.
template <class F>
auto located_in(const std::string& file, const pigment::SampleTable& table, F&& f) {
  try {
    return f();
  } catch (const std::domain_error& e) {
    rethrow_located(file, table, e);
  }
}

/// Calls `pigment::fit`, with errors located in the file.
pigment::Fit fit_file(const std::string& file, const pigment::SampleTable& table,
                      const pigment::FitSettings& settings);

/// Returns the paints with a positive fraction in a recipe.
std::vector<pigment::Component> components_of(const pigment::Palette& palette,
                                              const std::vector<double>& fractions);

/// A palette's pigments with K, S and their errors, as JSON.
nlohmann::json palette_json(const pigment::Palette& palette);

}  // namespace aureole
