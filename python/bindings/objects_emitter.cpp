// SPDX-License-Identifier: Apache-2.0
// Emitters over arrays.
#include <nanobind/stl/shared_ptr.h>

#include "aureole/emitter/emitter.h"
#include "bindings.h"
#include "object_arrays.h"

namespace aureole::python {

void bind_emitters(nb::module_& m) { nb::class_<Emitter, Object>(m, "Emitter"); }

}  // namespace aureole::python
