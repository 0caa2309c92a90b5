// SPDX-License-Identifier: Apache-2.0
// Recipes as text: "cold yellow: 0.19 + white: 0.35".
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace aureole::pigment {

/// A paint by name and its share of a mixture.
struct Component {
  std::string name;
  double fraction = 1;
};

/// Names and amounts after a colon, joined by '+'; a single name needs no amount. Amounts are parts, divided
/// by their sum, or all per cent ("30%"), and must then sum to 100. Throws std::domain_error that quotes the
/// fault: an amount that is no number, missing, negative or zero, a name twice, per cent that do not sum.
std::vector<Component> parse_recipe(std::string_view text);

/// The same as text, shares in per cent with `digits` behind the point.
std::string recipe_text(const std::vector<Component>& recipe, int digits = 2);

}  // namespace aureole::pigment
