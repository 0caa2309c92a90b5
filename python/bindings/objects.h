// SPDX-License-Identifier: Apache-2.0
// Plug-in objects as Python sees them.
#pragma once

#include <memory>

#include "aureole/plugin/object.h"
#include "bindings.h"

namespace aureole {
class Scene;
}

namespace aureole::python {

/// The object as the most derived class that Python knows; None for null.
nb::object cast_object(const ObjectPtr& object);

/// Makes this the scene in which its emitters are evaluated, until they are part of a later one.
void remember_lights(const std::shared_ptr<const Scene>& scene);

}  // namespace aureole::python
