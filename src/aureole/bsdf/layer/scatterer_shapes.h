// SPDX-License-Identifier: Apache-2.0
// The scatterers of a layer from its parameters. Part of the BSDF `correlated_scatterers`.
#pragma once

#include <vector>

#include "aureole/optics/layer/scatterer_mixture.h"
#include "aureole/plugin/properties.h"

namespace aureole {

/// Lengths in metres. `correlation_radius`: of the discs that keep scatterers apart; `largest`: of the
/// smallest circle around the largest of them.
struct LayerShapes {
  std::vector<optics::Scatterer> scatterers;
  double correlation_radius, largest;
};

/// Reads "radius" or the nested apertures, and "correlation_radius". Throws located errors.
LayerShapes read_layer_shapes(const Properties& p);

}  // namespace aureole
