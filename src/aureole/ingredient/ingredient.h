// SPDX-License-Identifier: Apache-2.0
// The ingredient family: particles or dissolved substances in a medium, and their concentrations. Amounts
// refer to the whole medium with all of its ingredients.
#pragma once

#include <memory>
#include <vector>

#include "aureole/optics/medium/suspension_model.h"
#include "aureole/plugin/object.h"
#include "aureole/plugin/properties.h"

namespace aureole {

/// The ingredients of a medium, as arguments of `optics::Suspension` and `optics::Solution`.
struct IngredientList {
  std::vector<optics::Ingredient> particles;
  std::vector<optics::Dye> dyes;
};

class Ingredient : public Object {
public:
  static constexpr const char* kFamily = "an ingredient of a medium";
  using Object::Object;

  virtual void add_to(IngredientList& list) const = 0;

protected:
  /// Returns the name for messages: the id, or the name of the plug-in.
  std::string name() const { return id().empty() ? properties().type() : id(); }
};
using IngredientPtr = std::shared_ptr<const Ingredient>;

}  // namespace aureole
