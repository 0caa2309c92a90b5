// SPDX-License-Identifier: Apache-2.0
// Scattering data of windows and shades in XML, as WINDOW of the Lawrence Berkeley National Laboratory and Radiance write
// them (schema BSDF-v1.4): which blocks of numbers a file has, for which directions and which part of the spectrum.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "aureole/core/error.h"

namespace aureole {

/// Rings of patches that cover a hemisphere: from `lower` to `upper` angles [degrees], each divided into equal azimuths,
/// the first of which is centred on azimuth 0 (J. H. Klems, "A new method for predicting the solar heat gain of complex
/// fenestration systems", ASHRAE Transactions 100(1), 1994).
struct AngleBasis {
  struct Ring {
    double lower, upper;
    int azimuths;
  };
  std::string name;
  std::vector<Ring> rings;

  std::size_t size() const;  ///< Returns the number of patches.
};

/// The bases that files may name without defining them: "LBNL/Klems Full", "... Half" and "... Quarter".
const std::vector<AngleBasis>& known_angle_bases();

/// A block of numbers. Front is the outside of the building in such files.
struct WindowBlock {
  bool is_transmission = false, is_front = false;
  int channel = 1;  ///< channel of the spectrum: 0, 1, 2 for CIE X, Y (the visible range), Z
  std::string column_basis, row_basis;
  std::string_view data;  ///< text of the numbers, as a part of the file's text
  SourceLocation where;   ///< position of `data`
};

struct WindowFile {
  enum class Structure { columns, rows, tree3, tree4 };
  std::string text;  ///< content of the file, which blocks refer to
  Structure structure = Structure::columns;
  SourceLocation structure_where;
  std::vector<AngleBasis> bases;  ///< bases that the file defines, then the known ones
  std::vector<WindowBlock> blocks;
  std::vector<std::string> skipped;  ///< spectral ranges and directions that were skipped, each once

  bool is_tree() const { return structure == Structure::tree3 || structure == Structure::tree4; }
  /// Returns the angle basis of that name. Throws Error located at `where`.
  const AngleBasis& basis(const std::string& name, const SourceLocation& where) const;
};

/// Reads the structure of a file. Throws Error located at the file's line.
std::unique_ptr<const WindowFile> read_window_file(const std::filesystem::path& file);

/// Reads numbers one after the other from the text of a block, separated by blanks or commas. Errors are
/// located at the line of the text.
class NumberReader {
public:
  NumberReader(std::string_view text, SourceLocation where) : rest_(text), where_(std::move(where)) {}

  /// Returns the next character that is neither a blank nor a comma, without consuming it; 0 at the end.
  char peek();
  /// Consumes `c`. Throws Error if another character comes.
  void expect(char c, const char* what);
  /// Reads a number. Throws Error if no finite number comes.
  double number();
  Error error(const std::string& message) const { return Error(where_, message); }

private:
  std::string_view rest_;
  SourceLocation where_;
};

}  // namespace aureole
