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
    if (number == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);  // byte order mark
    line.resize(std::min(line.find('#'), line.size()));
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    words.imbue(std::locale::classic());
    if (!(words >> std::ws) || words.eof()) continue;
    std::pair<double, double> row;
    if (rows.empty() && (std::isalpha(words.peek()) || words.peek() == '"')) continue;
    if (!(words >> row.first >> row.second) || !(words.eof() || std::isspace(words.peek())))
      throw std::domain_error("line " + std::to_string(number) + ": expected two numbers, got \"" + line +
                              "\"");
    rows.push_back(row);
    if (number > 100000) throw std::domain_error("the table has more than 100000 lines");
  }
  return rows;
}

}  // namespace aureole::optics
