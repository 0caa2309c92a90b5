// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "aureole/plugin/properties.h"

namespace aureole {

/// Calls `visit` for all objects among the parameters and, recursively, among the parameters of these
/// objects.
inline void visit_nested(const Properties& properties, const std::function<void(const ObjectPtr&)>& visit) {
  for (const auto& e : properties.entries())
    if (const auto* nested = std::get_if<ObjectPtr>(&e.value); nested && *nested) {
      visit(*nested);
      visit_nested((*nested)->properties(), visit);
    }
}

}  // namespace aureole
