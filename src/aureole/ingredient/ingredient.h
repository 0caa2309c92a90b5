// SPDX-License-Identifier: Apache-2.0
// The ingredient family: what floats or is dissolved in a medium, and how much of it. Amounts are of the whole
// medium with all of its ingredients.
#pragma once

#include <memory>
#include <vector>

#include "aureole/optics/medium/suspension_model.h"
#include "aureole/plugin/object.h"
#include "aureole/plugin/properties.h"

namespace aureole {

/// The ingredients of a medium as `optics::Suspension` and `optics::Solution` take them.
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
  /// For messages: the id, or the name of the plug-in.
  std::string name() const { return id().empty() ? properties().type() : id(); }
};
using IngredientPtr = std::shared_ptr<const Ingredient>;

}  // namespace aureole
