// SPDX-License-Identifier: Apache-2.0
// Comma-separated values with the positions of their cells.
#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace aureole::pigment {

struct TextCell {
  std::string text;  ///< without surrounding blanks and quotes
  int column = 0;    ///< from 1
};

struct TextRow {
  std::vector<TextCell> cells;
  int line = 0;  ///< from 1
};

/// Reads all lines except empty ones and lines that begin with '#'. A cell that contains a comma must be in
/// double quotes. Throws TextError for an unterminated quote, and for more than 100,000 lines.
std::vector<TextRow> read_text_table(std::istream& text);

/// Returns the text as a finite number, or nothing if it is not one.
std::optional<double> finite_number(std::string_view text);
/// Returns the cell as a finite number; throws TextError that quotes it.
double number_of(const TextRow& row, std::size_t cell);

}  // namespace aureole::pigment
