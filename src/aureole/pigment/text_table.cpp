// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/text_table.h"

#include <charconv>
#include <cmath>
#include <istream>

#include "aureole/pigment/samples.h"

namespace aureole::pigment {

std::vector<TextRow> read_text_table(std::istream& text) {
  std::vector<TextRow> rows;
  std::string line;
  for (int number = 1; std::getline(text, line); ++number) {
    if (number == 1 && line.starts_with("\xEF\xBB\xBF"))
      line.erase(0, 3);  // byte order mark written by
                         // spreadsheets
    if (number > 100000) throw TextError(number, 0, "the table has more than 100000 lines");
    const auto first = line.find_first_not_of(" \t\r,");
    if (first == line.npos || line[first] == '#') continue;
    TextRow row{{}, number};
    for (std::size_t begin = 0; begin <= line.size();) {
      TextCell cell;
      begin = std::min(line.find_first_not_of(" \t", begin), line.size());
      cell.column = int(begin) + 1;
      std::size_t end;
      if (begin < line.size() && line[begin] == '"') {
        const std::size_t close = line.find('"', begin + 1);
        if (close == line.npos) throw TextError(number, cell.column, "the quote does not end");
        cell.text = line.substr(begin + 1, close - begin - 1);
        end = std::min(line.find(',', close), line.size());
      } else {
        end = std::min(line.find(',', begin), line.size());
        cell.text = line.substr(begin, end - begin);
      }
      cell.text.erase(cell.text.find_last_not_of(" \t\r") + 1);
      row.cells.push_back(std::move(cell));
      begin = end + 1;
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

std::optional<double> finite_number(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return {};
  return value;
}

double number_of(const TextRow& row, std::size_t cell) {
  const std::string& text = row.cells[cell].text;
  if (const auto value = finite_number(text)) return *value;
  throw TextError(row.line, row.cells[cell].column, "expected a number, got \"" + text + "\"");
}

}  // namespace aureole::pigment
