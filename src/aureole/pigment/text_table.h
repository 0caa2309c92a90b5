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
  std::string text;  ///< text without surrounding blanks and quotes
  int column = 0;    ///< number of the column, from 1
  int line = 0;  ///< line number from 1, where it differs from the row's, in a table that is read by columns
};

struct TextRow {
  std::vector<TextCell> cells;
  int line = 0;  ///< line number, from 1
};

/// Reads all lines except empty ones and lines that begin with '#'. A cell that contains the separator must be in
/// double quotes; a quote within is doubled. Throws TextError for an unterminated quote, and for more than 100,000
/// lines.
std::vector<TextRow> read_text_table(std::istream& text, char separator = ',');

/// Changes decimal commas to points in all cells that are numbers with one comma; returns whether there are any.
bool change_decimal_commas(std::vector<TextRow>& rows);

/// Reads a table of two columns, of which the second, or both, are numbers: separated by commas, semicolons, tabs or (if
/// both are numbers) blanks, with decimal points or commas. The rows include a first line of headings.
std::vector<TextRow> read_pairs(const std::string& text, bool both_are_numbers);

/// Text as UTF-8: UTF-16 with or without a byte order mark is converted, a byte order mark is removed, and line ends
/// of "\r" alone become "\n". Other text that is not UTF-8 is read as Windows-1252, with a note unless
/// `notes` is null.
std::string utf8_text(std::string bytes, std::vector<std::string>* notes = nullptr);

/// Returns the text as a finite number, or nothing if it is not one.
std::optional<double> finite_number(std::string_view text);
/// Returns the cell as a finite number; throws TextError that quotes it.
double number_of(const TextRow& row, std::size_t cell);

}  // namespace aureole::pigment
