// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/text_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <istream>
#include <sstream>

#include "aureole/pigment/samples.h"

namespace aureole::pigment {

std::vector<TextRow> read_text_table(std::istream& text, char separator) {
  std::vector<TextRow> rows;
  std::string line;
  const std::string blanks = separator == '\t' ? " " : " \t";
  for (int number = 1; std::getline(text, line); ++number) {
    if (number == 1 && line.starts_with("\xEF\xBB\xBF"))
      line.erase(0, 3);  // removes the byte order mark that spreadsheets write
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

namespace {

void append_utf8(std::string& text, unsigned code) {
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

/// Whether every byte above 127 is part of a sequence of UTF-8.
bool is_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if (byte < 0x80) continue;
    const std::size_t more = byte >= 0xF0 && byte < 0xF5   ? 3
                             : byte >= 0xE0 && byte < 0xF0 ? 2
                             : byte >= 0xC2 && byte < 0xE0 ? 1
                                                           : 0;
    if (more == 0 || i + more >= text.size()) return false;
    for (std::size_t j = 1; j <= more; ++j)
      if ((static_cast<unsigned char>(text[i + j]) & 0xC0) != 0x80) return false;
    i += more;
  }
  return true;
}

/// Windows-1252 is Latin-1 except for the characters from 0x80 on; 0: no character.
constexpr unsigned kWindows1252[32] = {0x20AC, 0,      0x201A, 0x0192, 0x201E, 0x2026, 0x2020, 0x2021,
                                       0x02C6, 0x2030, 0x0160, 0x2039, 0x0152, 0,      0x017D, 0,
                                       0,      0x2018, 0x2019, 0x201C, 0x201D, 0x2022, 0x2013, 0x2014,
                                       0x02DC, 0x2122, 0x0161, 0x203A, 0x0153, 0,      0x017E, 0x0178};

std::string from_windows_1252(std::string_view bytes) {
  std::string text;
  for (const char c : bytes) {
    const unsigned code = static_cast<unsigned char>(c);
    const bool special = code >= 0x80 && code < 0xA0;
    append_utf8(text, !special ? code : kWindows1252[code - 0x80] ? kWindows1252[code - 0x80] : 0xFFFD);
  }
  return text;
}

}  // namespace

bool change_decimal_commas(std::vector<TextRow>& rows) {
  bool any = false;
  for (TextRow& row : rows)
    for (TextCell& cell : row.cells) {
      if (std::count(cell.text.begin(), cell.text.end(), ',') != 1 || cell.text.find('.') != cell.text.npos)
        continue;
      std::string text = cell.text;
      text[text.find(',')] = '.';
      if (finite_number(text)) cell.text = std::move(text), any = true;
    }
  return any;
}

std::vector<TextRow> read_pairs(const std::string& text, bool both_are_numbers) {
  std::vector<TextRow> best;
  std::size_t most = 0;
  // A comma may be a decimal comma, so that it is tried after the other separators.
  for (const char separator : {';', '\t', ',', ' '}) {
    if (separator == ' ' && !both_are_numbers) continue;
    std::istringstream stream(text);
    std::vector<TextRow> rows = read_text_table(stream, separator);
    for (TextRow& row : rows)  // removes empty cells from blanks at the ends of lines
      while (separator == ' ' && row.cells.size() > 2 && row.cells.back().text.empty()) row.cells.pop_back();
    change_decimal_commas(rows);
    std::size_t count = 1;
    for (const TextRow& row : rows)
      count += row.cells.size() == 2 && finite_number(row.cells[1].text) &&
               (!both_are_numbers || finite_number(row.cells[0].text));
    if (count > most || (most == 1 && separator == ',')) best = std::move(rows), most = count;
  }
  return best;
}

std::string utf8_text(std::string bytes, std::vector<std::string>* notes) {
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
      append_utf8(text, code);
    }
  } else {
    text = std::move(bytes);
    if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
    if (!is_utf8(text)) {
      text = from_windows_1252(text);
      if (notes) notes->push_back("the text is not UTF-8 and is taken for Windows-1252");
    }
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
