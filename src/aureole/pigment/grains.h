// SPDX-License-Identifier: Apache-2.0
// Paint from its microstructure: pigment particles in a binder, given by material and size.
#pragma once

#include <span>

#include "aureole/core/parallel_for.h"
#include "aureole/optics/medium/suspension_model.h"
#include "aureole/pigment/paints.h"
#include "aureole/pigment/transport_coefficients.h"

namespace aureole::pigment {

/// K and S, per metre, of particles in a binder (`optics::Suspension`: the binder is its host), by Mie theory
/// and a convention; `nm` must increase. For the convention `diffusion`, negative S is set to 0. Particles of
/// an ingredient scatter independently unless it sets `hard_spheres`. Above some 5 % of the volume, dependent
/// scattering makes S smaller than in this model. Throws std::domain_error as `Suspension` does.
Paint paint_of_grains(const optics::Suspension& suspension, std::span<const double> nm,
                      Convention convention = Convention::three_quarters,
                      const ParallelFor& parallel_for = serial_for);

}  // namespace aureole::pigment
