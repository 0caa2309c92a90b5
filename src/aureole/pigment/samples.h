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
  double thickness = 0;           ///< [m]; 0: unknown
  std::string series = {};        ///< what was made from the same batches of paint; for joint_fit.h
  std::string specimen = {};      ///< the layer that was measured; samples of one specimen have one thickness
  std::vector<double> values;     ///< fractions, as measured, one per wavelength
  int line = 0;                   ///< line number in the file, from 1; 0: not from a text file
  std::vector<int> columns = {};  ///< column numbers of the values in that line
};

struct SampleTable {
  std::vector<double> nm;
  std::vector<Sample> samples;
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
  int wavelength() const { return wavelength_; }  ///< index of the wavelength, or -1

private:
  std::size_t sample_;
  int wavelength_;
};

/// Reads comma-separated values. Empty lines and lines beginning with '#' are skipped. The first line names
/// the columns: "paints" (a recipe; required), "sample", "quantity" (R or T), "backing", "thickness_um",
/// "unit" ("fraction", the default, or "percent"), and wavelengths in nm in increasing order. Throws
/// TextError.
SampleTable read_samples(std::istream& text);

/// Throws SampleError for a table that cannot be fitted: no wavelengths or samples, numbers of values and
/// wavelengths that differ, values that are not finite or negative, wavelengths that do not increase.
void check(const SampleTable& table);

}  // namespace aureole::pigment
