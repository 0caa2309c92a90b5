// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/text_table.h"

#include <charconv>
#include <cmath>
#include <istream>

#include "aureole/pigment/samples.h"

namespace aureole::pigment {

std::vector<TextRow> read_text_table(std::istream& text, char separator) {
  std::vector<TextRow> rows;
  std::string line;
  const std::string blanks = separator == '\t' ? " " : " \t";
  for (int number = 1; std::getline(text, line); ++number) {
    if (number == 1 && line.starts_with("\xEF\xBB\xBF"))
      line.erase(0, 3);  // byte order mark written by
                         // spreadsheets
    if (number > 100000) throw TextError(number, 0, "the table has more than 100000 lines");
    const auto first = line.find_first_not_of(std::string(" \t\r") + separator);
    if (first == line.npos || line[first] == '#') continue;
    TextRow row{{}, number};
    for (std::size_t begin = 0; begin <= line.size();) {
      TextCell cell;
      begin = std::min(line.find_first_not_of(blanks, begin), line.size());
      cell.column = int(begin) + 1;
      std::size_t end;
      if (begin < line.size() && line[begin] == '"') {
        std::size_t close = begin;
        for (;;) {
          const std::size_t next = line.find('"', close + 1);
          if (next == line.npos) throw TextError(number, cell.column, "the quote does not end");
          cell.text += line.substr(close + 1, next - close - 1);
          close = next;
          if (close + 1 >= line.size() || line[close + 1] != '"') break;
          cell.text += '"';
          ++close;
        }
        end = std::min(line.find(separator, close + 1), line.size());
      } else {
        end = std::min(line.find(separator, begin), line.size());
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

std::string utf8_text(std::string bytes) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(bytes[i]); };
  bool wide = false, big_endian = false;
  std::size_t at = 0;
  if (bytes.size() >= 2 && ((byte(0) == 0xFF && byte(1) == 0xFE) || (byte(0) == 0xFE && byte(1) == 0xFF))) {
    wide = true, big_endian = byte(0) == 0xFE, at = 2;
  } else if (bytes.size() >= 4 && (byte(0) == 0) != (byte(1) == 0) && (byte(2) == 0) != (byte(3) == 0)) {
    wide = true, big_endian = byte(0) == 0;
  }
  std::string text;
  if (wide) {
    const auto unit = [&](std::size_t i) {
      return big_endian ? unsigned(byte(i) << 8 | byte(i + 1)) : unsigned(byte(i + 1) << 8 | byte(i));
    };
    for (; at + 1 < bytes.size(); at += 2) {
      unsigned code = unit(at);
      if (code >= 0xD800 && code < 0xDC00 && at + 3 < bytes.size()) {
        code = 0x10000 + ((code - 0xD800) << 10) + (unit(at + 2) - 0xDC00);
        at += 2;
      }
      if (code < 0x80) {
        text += char(code);
      } else if (code < 0x800) {
        text += {char(0xC0 | code >> 6), char(0x80 | (code & 0x3F))};
      } else if (code < 0x10000) {
        text += {char(0xE0 | code >> 12), char(0x80 | (code >> 6 & 0x3F)), char(0x80 | (code & 0x3F))};
      } else {
        text += {char(0xF0 | code >> 18), char(0x80 | (code >> 12 & 0x3F)), char(0x80 | (code >> 6 & 0x3F)),
                 char(0x80 | (code & 0x3F))};
      }
    }
  } else {
    text = std::move(bytes);
    if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
  }
  if (text.find('\n') == text.npos)
    for (char& c : text)
      if (c == '\r') c = '\n';
  return text;
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
  throw TextError(row.cells[cell].line ? row.cells[cell].line : row.line, row.cells[cell].column,
                  "expected a number, got \"" + text + "\"");
}

}  // namespace aureole::pigment
