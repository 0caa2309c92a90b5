// SPDX-License-Identifier: Apache-2.0
// Measured samples of paint, and reading them from text tables.
#pragma once

#include <iosfwd>
#include <stdexcept>
#include <string>
#include <vector>

#include "aureole/pigment/recipe.h"

namespace aureole::pigment {

/// One measurement. Samples with equal paints, quantity, backing and thickness are repeats of each other.
struct Sample {
  enum class Quantity { reflectance, transmittance };

  std::string name;
  std::vector<Component> paints;  ///< empty: a bare substrate, to which other samples refer as their backing
  Quantity quantity = Quantity::reflectance;
  /// "opaque": an opaque layer; "none": a free film; the name of a bare substrate among the samples; or a
  /// number, the inner reflectance of the substrate.
  std::string backing = "opaque";
  bool states_backing = false;  ///< whether the file states the backing; otherwise it is assumed to be opaque
  double thickness = 0;         ///< thickness [m]; 0: unknown
  std::string series = {};  ///< name of a series of samples from the same batches of paint, for joint_fit.h
  /// name of the layer that was measured; samples of one specimen have one thickness
  std::string specimen = {};
  std::vector<double> values;     ///< fractions, as measured, one per wavelength
  int line = 0;                   ///< line number in the file, from 1; 0: not from a text file
  std::vector<int> columns = {};  ///< column numbers of the values in that line
  std::vector<int> lines = {};    ///< line numbers of the values, if they differ: wavelengths down
  std::string file = {};          ///< the file, in a table that several files were joined to
  bool is_named_recipe =
      false;  ///< whether the name alone stands for the recipe: it may be that of a bare card
};

/// Measurement conditions of an instrument, as far as a file states them; empty: not stated.
struct Instrument {
  std::string geometry;  ///< "diffuse", "d8" or "45_0", as `geometry_called` knows them
  std::string specular;  ///< specular component: "included" or "excluded"
  std::string aperture;  ///< aperture, by size or name

  bool operator==(const Instrument&) const = default;
};
/// The geometry that a text states, such as "45/0", "d/8 SCI" or "Sphere, specular excluded".
Instrument instrument_called(const std::string& text);

struct SampleTable {
  std::vector<double> nm;
  std::vector<Sample> samples;
  std::vector<std::string> notes = {};  ///< assumptions made on reading the file, for the user to confirm
  Instrument instrument = {};
};

/// An error in a text and its position, counting from 1 (0: unknown).
class TextError : public std::domain_error {
public:
  TextError(int line, int column, const std::string& message)
      : std::domain_error(message), line_(line), column_(column) {}
  int line() const { return line_; }
  int column() const { return column_; }

private:
  int line_, column_;
};

/// An error in a measured sample, optionally at one of its wavelengths.
class SampleError : public std::domain_error {
public:
  SampleError(std::size_t sample, int wavelength, const std::string& message)
      : std::domain_error(message), sample_(sample), wavelength_(wavelength) {}
  std::size_t sample() const { return sample_; }
  int wavelength() const { return wavelength_; }  ///< Returns the index of the wavelength, or -1.

private:
  std::size_t sample_;
  int wavelength_;
};

/// The end of an error on a measurement: the line of a table, without its values, that would be right for `sample`, below its
/// headings.
std::string right_sample_line(const Sample& sample);
/// As above, for a sample after `change(sample)`.
template <class Change>
std::string right_sample_line(Sample sample, const Change& change) {
  change(sample);
  return right_sample_line(sample);
}

/// The end of an error on a value that no paint can have: the line of a table, with its unit and this value at `nm`, that would be
/// right for `sample`.
std::string right_value_line(const Sample& sample, double nm, bool is_percent, double value);
/// As above, for a reflectance above `most`. A value above 1.5 is taken for one in per cent if that is possible.
std::string right_reflectance_line(const Sample& sample, double nm, double value, double most);

/// Whether a table must state the recipes of its samples. Colours alone do not need them.
enum class Recipes { required, optional };

/// Reads a table of text as laboratories write it. Cells are separated by commas, semicolons or tabs; with the last
/// two, numbers may have decimal commas. Text may be UTF-16 or Windows-1252. Empty columns at the end, lines before the table, empty lines and lines beginning
/// with '#' are skipped. A line names the columns, in any case: "paints" (a recipe; required), "sample", "specimen",
/// "series", "quantity" (R or T), "backing", "thickness_um" (or "thickness (mm)"), "unit" ("fraction" or "percent"),
/// and wavelengths: "400", "400nm", "R400", "nm400", "%R 400" and the like, in any order. Wavelengths that all come
/// several times are repeats. Columns "T400" and the like are transmittances of the free film whose reflectances
/// stand in the others. Other columns are not used, unless their names are nearly those of known ones. Missing values
/// between two neighbours no more than 40 nm apart are interpolated, and wavelengths at the ends that a sample lacks are
/// left out for all. Instead, the first column may have these names, and the others one measurement each.
/// Without a unit, values above 1.5 are taken for per cent. What is assumed or not used is in `notes`. Throws
/// TextError that says what was expected and gives a line that would be right.
SampleTable read_samples(std::istream& text, Recipes recipes = Recipes::required);

/// An empty table with examples, for a spreadsheet.
std::string sample_table_template();

/// The mean of repeats: reflectances of one name, recipe, backing and thickness.
struct Panel {
  /// The sample's name, followed by backing, thickness or recipe where the name alone is not unique: "ochre over card".
  std::string name;
  std::vector<double> values;
  int count = 0;                  ///< number of repeats
  const Sample* first = nullptr;  ///< one of the repeats, in the table
};

/// The reflectances of a table as panels, in the file's order.
std::vector<Panel> panels_of(const SampleTable& table);
/// The panels of a name, either as the file has it or as `Panel::name` says it.
std::vector<Panel> panels_called(const std::vector<Panel>& panels, const std::string& name);

/// Changes backings that are a card's name in another case to this name, with a note.
void match_card_names(SampleTable& table);
/// Settles the backings of a table that was read from a file: `match_card_names`, and layers without a backing beside others of
/// the same recipe or specimen that state one are noted. Throws SampleError for a layer with a thickness and without a backing.
void settle_backings(SampleTable& table);

/// Throws SampleError for a reflectance above 1.05, which no paint has: the value may be in per cent.
void check_not_above_white(const SampleTable& table);

/// Throws SampleError for a table that cannot be fitted: no wavelengths or samples, numbers of values and
/// wavelengths that differ, values that are not finite or negative, wavelengths that do not increase.
void check(const SampleTable& table);

}  // namespace aureole::pigment
