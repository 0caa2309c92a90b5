// SPDX-License-Identifier: Apache-2.0
// The possible colour error of the two-flux theory for a layer of paint, against radiative transfer.
#pragma once

#include "aureole/pigment/observation.h"
#include "aureole/pigment/paints.h"

namespace aureole {

/// CIEDE2000 between a layer's colour by Kubelka and Munk and by transport, for coefficients that stand for K = 2 sigma_a
/// and S = 3/4 sigma_s (1 - g); the larger one of g = 0 and g = 0.8. Diffuse light, an interface of `index`. `thickness`
/// is in the inverse unit of K and S and finite. The error is largest for thin, dark and forward-scattering
/// layers (docs/pigments.md). K and S that were fitted to layers of like thickness compensate a part of it.
double two_flux_doubt(const pigment::Paint& paint, const std::vector<double>& nm, double thickness,
                      double substrate, double index, const pigment::Observation& lamp);

}  // namespace aureole
