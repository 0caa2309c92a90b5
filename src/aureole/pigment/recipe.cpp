// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/recipe.h"

#include <charconv>
#include <cmath>
#include <optional>

#include "aureole/pigment/domain.h"

namespace aureole::pigment {
namespace {

std::string_view trimmed(std::string_view text) {
  const auto begin = text.find_first_not_of(" \t");
  if (begin == text.npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

/// The last colon outside double quotes, or npos.
std::size_t amount_colon(std::string_view part) {
  bool quoted = false;
  std::size_t last = part.npos;
  for (std::size_t i = 0; i < part.size(); ++i) {
    if (part[i] == '"') quoted = !quoted;
    if (!quoted && part[i] == ':') last = i;
  }
  return last;
}

/// The parts of a recipe, between the plus signs outside double quotes.
std::vector<std::string_view> parts_of(std::string_view text) {
  std::vector<std::string_view> parts;
  bool quoted = false;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '"') quoted = !quoted;
    if (quoted || text[i] != '+') continue;
    parts.push_back(trimmed(text.substr(begin, i - begin)));
    begin = i + 1;
  }
  parts.push_back(trimmed(text.substr(begin)));
  return parts;
}

/// A name without the double quotes around it.
std::string unquoted(std::string_view name) {
  if (name.size() >= 2 && name.front() == '"' && name.back() == '"') name = name.substr(1, name.size() - 2);
  return std::string(name);
}

/// Rewrites "10% ochre" as "ochre: 10%"; returns other texts unchanged.
std::string amount_last(std::string_view part) {
  const auto percent = part.find('%');
  if (percent == part.npos || percent + 1 == part.size() || amount_colon(part) != part.npos ||
      trimmed(part.substr(0, percent)).find_first_not_of("0123456789.eE+-") != std::string_view::npos)
    return std::string(part);
  return std::string(trimmed(part.substr(percent + 1))) + ": " + std::string(part.substr(0, percent + 1));
}

/// The number of an amount, without its per cent sign, or nothing.
std::optional<double> amount_of(std::string_view text) {
  if (text.ends_with('%')) text = trimmed(text.substr(0, text.size() - 1));
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return {};
  return value;
}

}  // namespace

std::vector<Component> parse_recipe(std::string_view text) {
  std::string whole(1, '"');
  whole.append(trimmed(text)).push_back('"');
  std::vector<Component> recipe;
  int percents = 0, amounts = 0;
  double sum = 0;
  const std::vector<std::string_view> parts = parts_of(text);
  for (const std::string_view one : parts) {
    // In a single part, a text such as "50% cyan" is the name of a patch.
    const std::string part = parts.size() > 1 ? amount_last(one) : std::string(one);
    const std::size_t colon = amount_colon(part);
    Component component{unquoted(trimmed(std::string_view(part).substr(0, colon))), 1};
    if (component.name.empty()) throw std::domain_error("recipe " + whole + ": a paint has no name");
    for (const Component& other : recipe)
      if (other.name == component.name)
        throw std::domain_error("recipe " + whole + ": \"" + component.name + "\" comes twice");
    if (colon != part.npos) {
      const std::string_view number = trimmed(std::string_view(part).substr(colon + 1));
      percents += number.ends_with('%');
      const auto amount = amount_of(number);
      if (!amount)
        throw std::domain_error("recipe " + whole + ": \"" + std::string(number) + "\" is no number");
      component.fraction = *amount;
      require(component.fraction > 0, component.fraction,
              "recipe " + whole + ": the amount of \"" + component.name + "\"", "must be positive");
      ++amounts;
    }
    sum += component.fraction;
    recipe.push_back(component);
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

bool is_recipe(std::string_view name) {
  const std::vector<std::string_view> parts = parts_of(name);
  for (const std::string_view one : parts) {
    const std::string part = parts.size() > 1 ? amount_last(one) : std::string(one);
    const std::size_t colon = amount_colon(part);
    if (colon == part.npos || trimmed(std::string_view(part).substr(0, colon)).empty()) return false;
    const std::string_view amount = trimmed(std::string_view(part).substr(colon + 1));
    if (!amount_of(amount) || (parts.size() == 1 && !amount.ends_with('%'))) return false;
  }
  return true;
}

std::vector<Component> recipe_of_name(std::string_view name, std::vector<std::string>& notes) {
  if (is_recipe(name)) return parse_recipe(name);
  const std::string whole(trimmed(name));
  if (whole.empty()) return {};
  if (whole.find_first_of("+:") != whole.npos)
    notes.push_back(
        "the name \"" + whole +
        "\" is taken for that of one paint: in a recipe each paint has an amount, as in \"red: 1 + white: 3\"");
  return {{whole, 1}};
}

std::string recipe_text(const std::vector<Component>& recipe, int digits) {
  std::string text;
  for (const Component& component : recipe) {
    char number[32];
    const auto end = std::to_chars(number, number + sizeof number, 100 * component.fraction,
                                   std::chars_format::fixed, digits);
    const bool plain = component.name.find_first_of("+:") == component.name.npos ||
                       component.name.find('"') != component.name.npos;
    text += (text.empty() ? "" : " + ") + (plain ? component.name : '"' + component.name + '"') + ": " +
            std::string(number, end.ptr) + "%";
  }
  return text;
}

}  // namespace aureole::pigment
