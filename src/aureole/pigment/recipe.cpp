// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/recipe.h"

#include <charconv>
#include <cmath>

#include "aureole/pigment/domain.h"

namespace aureole::pigment {
namespace {

std::string_view trimmed(std::string_view text) {
  const auto begin = text.find_first_not_of(" \t");
  if (begin == text.npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

/// Rewrites "10% ochre" as "ochre: 10%", stored in `turned`; returns other texts unchanged.
std::string_view amount_last(std::string_view part, std::string& turned) {
  const auto percent = part.find('%');
  if (percent == part.npos || percent + 1 == part.size() || part.find(':') != part.npos) return part;
  if (trimmed(part.substr(0, percent)).find_first_not_of("0123456789.eE+-") != std::string_view::npos)
    return part;
  turned = std::string(trimmed(part.substr(percent + 1))) + ": " + std::string(part.substr(0, percent + 1));
  return turned;
}

}  // namespace

std::vector<Component> parse_recipe(std::string_view text) {
  std::string whole(1, '"');
  whole.append(trimmed(text)).push_back('"');
  std::vector<Component> recipe;
  int percents = 0, amounts = 0;
  double sum = 0;
  for (std::string_view rest = text;;) {
    const auto plus = rest.find('+');
    std::string turned;
    std::string_view part = trimmed(rest.substr(0, plus));
    // Without a '+', a text such as "50% cyan" is the name of a patch.
    if (text.find('+') != text.npos) part = amount_last(part, turned);
    const auto colon = part.rfind(':');
    Component component{std::string(trimmed(part.substr(0, colon))), 1};
    if (component.name.empty()) throw std::domain_error("recipe " + whole + ": a paint has no name");
    for (const Component& other : recipe)
      if (other.name == component.name)
        throw std::domain_error("recipe " + whole + ": \"" + component.name + "\" comes twice");
    if (colon != part.npos) {
      std::string_view number = trimmed(part.substr(colon + 1));
      const bool percent = number.ends_with('%');
      if (percent) number = trimmed(number.substr(0, number.size() - 1)), ++percents;
      const auto [end, error] =
          std::from_chars(number.data(), number.data() + number.size(), component.fraction);
      if (error != std::errc() || end != number.data() + number.size() || !std::isfinite(component.fraction))
        throw std::domain_error("recipe " + whole + ": \"" + std::string(number) + "\" is no number");
      require(component.fraction > 0, component.fraction,
              "recipe " + whole + ": the amount of \"" + component.name + "\"", "must be positive");
      ++amounts;
    }
    sum += component.fraction;
    recipe.push_back(component);
    if (plus == rest.npos) break;
    rest.remove_prefix(plus + 1);
  }
  if (amounts != int(recipe.size()) && (recipe.size() > 1 || amounts > 0))
    throw std::domain_error("recipe " + whole +
                            ": write an amount behind each paint, as in \"red: 1 + white: 3\"");
  if (percents != 0 && percents != amounts)
    throw std::domain_error("recipe " + whole + ": amounts are parts or per cent, not both");
  if (percents != 0)
    require(std::abs(sum - 100) < 0.01, sum, "recipe " + whole + ": per cent", "must sum to 100");
  for (Component& component : recipe) component.fraction /= sum;
  return recipe;
}

std::string recipe_text(const std::vector<Component>& recipe, int digits) {
  std::string text;
  for (const Component& component : recipe) {
    char number[32];
    const auto end = std::to_chars(number, number + sizeof number, 100 * component.fraction,
                                   std::chars_format::fixed, digits);
    text += (text.empty() ? "" : " + ") + component.name + ": " + std::string(number, end.ptr) + "%";
  }
  return text;
}

}  // namespace aureole::pigment
