// SPDX-License-Identifier: Apache-2.0
// The parts of `bind_optics`.
#pragma once

#include "aureole/optics/particle/radius_distribution.h"
#include "bindings.h"

namespace aureole::python {

void bind_apertures(nb::module_& m);
void bind_correlations(nb::module_& m);  ///< hard discs, structure factors, pair correlation
void bind_diffraction(nb::module_& m);
void bind_edge_kernels(nb::module_& m);  ///< edges as scatterers of light
void bind_absorption(nb::module_& m);    ///< in all its quantities; phase functions in closed form
void bind_sizes(nb::module_& m);         ///< of particles
void bind_stack(nb::module_& m);         ///< plane layers
void bind_radiometry(nb::module_& m);    ///< solid angles, glare, mesopic vision

/// Radii in m whose logarithms are normal with standard deviation `spread`; one radius for 0.
optics::RadiusDistribution log_normal_radii(double median, double spread, bool by_volume);

}  // namespace aureole::python
