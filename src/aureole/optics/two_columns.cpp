// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/two_columns.h"

#include <algorithm>
#include <cctype>
#include <istream>
#include <sstream>
#include <stdexcept>
#include <string>

namespace aureole::optics {

std::vector<std::pair<double, double>> read_two_columns(std::istream& text) {
  std::vector<std::pair<double, double>> rows;
  std::string line;
  for (int number = 1; std::getline(text, line); ++number) {
    if (number == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);  // skips the byte order mark
    line.resize(std::min(line.find('#'), line.size()));
    std::string plain = line;
    // whether semicolons separate numbers, which may then have decimal commas
    const bool has_semicolons = line.find(';') != line.npos;
    std::replace(plain.begin(), plain.end(), ',', has_semicolons ? '.' : ' ');
    std::replace(plain.begin(), plain.end(), ';', ' ');
    if (line.find_first_of("0123456789") <
        line.find_first_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"))
      std::erase(plain, '"');  // removes the quotation marks of quoted numbers
    std::istringstream words(plain);
    words.imbue(std::locale::classic());
    if (!(words >> std::ws) || words.eof()) continue;
    std::pair<double, double> row;
    if (rows.empty() && (std::isalpha(words.peek()) || words.peek() == '"')) continue;
    const bool has_two = (words >> row.first >> row.second) && (words.eof() || std::isspace(words.peek()));
    if (!has_two || ((words >> std::ws) && !words.eof()))
      throw std::domain_error("line " + std::to_string(number) + ": expected two numbers" +
                              (has_two ? " and no third column" : "") + ", got \"" + line +
                              "\"; blanks, commas or semicolons separate them");
    rows.push_back(row);
    if (number > 100000) throw std::domain_error("the table has more than 100000 lines");
  }
  return rows;
}

}  // namespace aureole::optics
