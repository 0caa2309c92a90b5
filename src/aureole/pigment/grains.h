// SPDX-License-Identifier: Apache-2.0
// From grains to paint: particles of pigment in a binder, by what they are made of and how large they are.
#pragma once

#include <span>

#include "aureole/core/parallel_for.h"
#include "aureole/optics/medium/suspension_model.h"
#include "aureole/pigment/paints.h"
#include "aureole/pigment/transport_coefficients.h"

namespace aureole::pigment {

/// K and S, per metre, of grains in a binder (`optics::Suspension`: the binder is its host), by Mie's theory
/// and a convention; `nm` increases. S of the convention `diffusion` is cut at 0, which no layer falls below.
/// Grains of one ingredient do not see their neighbours unless it says `hard_spheres`: above some 5 % of the
/// volume, crowding makes S smaller than this theory has it. Throws std::domain_error as `Suspension` does.
Paint paint_of_grains(const optics::Suspension& suspension, std::span<const double> nm,
                      Convention convention = Convention::three_quarters,
                      const ParallelFor& parallel_for = serial_for);

}  // namespace aureole::pigment
