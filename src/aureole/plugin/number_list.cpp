// SPDX-License-Identifier: Apache-2.0
#include "aureole/plugin/number_list.h"

#include <algorithm>
#include <string>

#include "aureole/core/units.h"
#include "aureole/plugin/properties.h"

namespace aureole {

namespace {

/// Splits the list `name` into words and returns the numbers that `parse` returns for them.
template <class Parse>
std::vector<double> parse_list(const Properties& properties, std::string_view name, const Parse& parse) {
  const std::string all = properties.get_string(name);
  std::vector<double> numbers;
  constexpr const char* kSeparators = ", \t\r\n";
  for (std::size_t at = all.find_first_not_of(kSeparators); at != std::string::npos;) {
    const std::size_t end = std::min(all.find_first_of(kSeparators, at), all.size());
    try {
      numbers.push_back(parse(std::string_view(all).substr(at, end - at)));
    } catch (const Error& problem) {
      throw properties.error(name, problem.message());
    }
    at = all.find_first_not_of(kSeparators, end);
  }
  return numbers;
}

}  // namespace

std::vector<double> get_number_list(const Properties& properties, std::string_view name) {
  return parse_list(properties, name, parse_number);
}

std::vector<double> get_wavelength_list(const Properties& properties, std::string_view name) {
  auto nm = parse_list(properties, name, parse_wavelength_nm);
  if (nm.size() < 2) throw properties.error(name, "needs at least two wavelengths");
  return nm;
}

double get_wavelength(const Properties& properties, std::string_view name) {
  const Properties::Entry* e = properties.find(name);
  if (!e || !std::holds_alternative<std::string>(e->value))
    return properties.get_float(name, Range::positive());
  try {
    const double nm = parse_wavelength_nm(std::get<std::string>(e->value));
    if (nm > 0) return nm;
  } catch (const Error& problem) {
    throw properties.error(name, problem.message());
  }
  throw properties.error(name, "a wavelength must be positive");
}

}  // namespace aureole
