// SPDX-License-Identifier: Apache-2.0
// Recipes as text: "cold yellow: 0.19 + white: 0.35".
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace aureole::pigment {

/// A paint by name and its fraction of a mixture.
struct Component {
  std::string name;
  double fraction = 1;
};

/// Parses names with amounts after a colon, joined by '+'; a single name needs no amount. Amounts are either
/// parts, which are divided by their sum, or all in per cent ("30%") with a sum of 100. Per cent may stand before the name:
/// "30% red + 70% white". A name in double quotes may contain '+' and ':'. Throws
/// std::domain_error that quotes the problem: an amount that is missing, negative, zero or not a number, a
/// duplicate name, or percentages with a wrong sum.
std::vector<Component> parse_recipe(std::string_view text);

/// Whether a text has the form of a recipe: two or more parts with an amount each, or one part with per cent.
bool is_recipe(std::string_view text);

/// The recipe that the name of a sample is in files without a field for recipes. Names that have not the form of a recipe,
/// such as "cyan+magenta", "lot 7: dry" or "50% cyan", are names of one paint; those with '+' or ':' get a note. Empty for an empty name. Throws as
/// `parse_recipe` for a recipe that is wrong, such as per cent that do not sum to 100.
std::vector<Component> recipe_of_name(std::string_view name, std::vector<std::string>& notes);

/// The recipe as text, names with '+' or ':' in double quotes, with fractions in per cent with `digits` decimals.
std::string recipe_text(const std::vector<Component>& recipe, int digits = 2);

}  // namespace aureole::pigment
