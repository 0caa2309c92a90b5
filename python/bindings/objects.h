// SPDX-License-Identifier: Apache-2.0
// Plug-in objects as Python sees them.
#pragma once

#include "aureole/plugin/object.h"
#include "bindings.h"

namespace aureole::python {

/// The object as the most derived class that Python knows; None for null.
nb::object cast_object(const ObjectPtr& object);

}  // namespace aureole::python
