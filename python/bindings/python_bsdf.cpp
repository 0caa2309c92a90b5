// SPDX-License-Identifier: Apache-2.0
#include "bindings.h"

namespace aureole::python {

void bind_python_bsdf(nb::module_& /*m*/) {}

}  // namespace aureole::python
