// SPDX-License-Identifier: Apache-2.0
// Comma-separated values with the places of their cells.
#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace aureole::pigment {

struct TextCell {
  std::string text;  ///< without blanks around it, nor quotes
  int column = 0;    ///< from 1
};

struct TextRow {
  std::vector<TextCell> cells;
  int line = 0;  ///< from 1
};

/// All lines but empty ones and those that begin with '#'. A cell with a comma stands in double quotes.
/// Throws TextError for a quote that does not end, and for more than 100,000 lines.
std::vector<TextRow> read_text_table(std::istream& text);

/// The text as a finite number, or nothing where it is none.
std::optional<double> finite_number(std::string_view text);
/// The cell as a finite number; throws TextError that quotes it.
double number_of(const TextRow& row, std::size_t cell);

}  // namespace aureole::pigment
