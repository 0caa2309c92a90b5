// SPDX-License-Identifier: Apache-2.0
#include "aureole/plugin/number_list.h"

#include <algorithm>
#include <string>

#include "aureole/core/units.h"
#include "aureole/plugin/properties.h"

namespace aureole {

std::vector<double> get_number_list(const Properties& properties, std::string_view name) {
  const std::string all = properties.get_string(name);
  std::vector<double> numbers;
  constexpr const char* kSeparators = ", \t\r\n";
  for (std::size_t at = all.find_first_not_of(kSeparators); at != std::string::npos;) {
    const std::size_t end = std::min(all.find_first_of(kSeparators, at), all.size());
    try {
      numbers.push_back(parse_number(std::string_view(all).substr(at, end - at)));
    } catch (const Error& problem) {
      throw properties.error(name, problem.message());
    }
    at = all.find_first_not_of(kSeparators, end);
  }
  return numbers;
}

}  // namespace aureole
