// SPDX-License-Identifier: Apache-2.0
// Measured samples of paint, and the tables of text that they come in.
#pragma once

#include <iosfwd>
#include <stdexcept>
#include <string>
#include <vector>

#include "aureole/pigment/recipe.h"

namespace aureole::pigment {

/// One measurement. Samples with the same paints, quantity, backing and thickness are repeats of one another.
struct Sample {
  enum class Quantity { reflectance, transmittance };

  std::string name;
  std::vector<Component> paints;  ///< empty: a bare substrate, which others name as their backing
  Quantity quantity = Quantity::reflectance;
  /// "opaque": so thick that nothing shows through; "none": a free film; the name of a bare substrate among
  /// the samples; or a number, the inner reflectance of the substrate.
  std::string backing = "opaque";
  double thickness = 0;           ///< m; 0: not known
  std::vector<double> values;     ///< fractions, as measured, one for each wavelength
  int line = 0;                   ///< of the file, from 1; 0: not from a text file
  std::vector<int> columns = {};  ///< of the values in that line
};

struct SampleTable {
  std::vector<double> nm;
  std::vector<Sample> samples;
};

/// A fault of a text: where it is, counting from 1 (0: not known).
class TextError : public std::domain_error {
public:
  TextError(int line, int column, const std::string& message)
      : std::domain_error(message), line_(line), column_(column) {}
  int line() const { return line_; }
  int column() const { return column_; }

private:
  int line_, column_;
};

/// A fault of a measured sample, perhaps at one of its wavelengths.
class SampleError : public std::domain_error {
public:
  SampleError(std::size_t sample, int wavelength, const std::string& message)
      : std::domain_error(message), sample_(sample), wavelength_(wavelength) {}
  std::size_t sample() const { return sample_; }
  int wavelength() const { return wavelength_; }  ///< its index, or -1

private:
  std::size_t sample_;
  int wavelength_;
};

/// Reads comma-separated values. Lines of '#' and empty ones are skipped. The first line names the columns:
/// "paints" (a recipe; needed), "sample", "quantity" (R or T), "backing", "thickness_um", "unit" ("fraction",
/// the default, or "percent"), and wavelengths in nm in increasing order. Throws TextError.
SampleTable read_samples(std::istream& text);

/// Throws SampleError for a table that no fit can use: without wavelengths or samples, with another number of
/// values than wavelengths, values that are not finite or negative, wavelengths that do not increase.
void check(const SampleTable& table);

}  // namespace aureole::pigment
