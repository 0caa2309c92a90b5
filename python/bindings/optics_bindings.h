// SPDX-License-Identifier: Apache-2.0
// The parts of `bind_optics`.
#pragma once

#include "bindings.h"

namespace aureole::python {

void bind_apertures(nb::module_& m);
void bind_correlations(nb::module_& m);  ///< hard discs, structure factors, pair correlation
void bind_diffraction(nb::module_& m);
void bind_edge_kernels(nb::module_& m);  ///< edges as scatterers of light
void bind_sizes(nb::module_& m);         ///< of particles
void bind_stack(nb::module_& m);         ///< plane layers

}  // namespace aureole::python
