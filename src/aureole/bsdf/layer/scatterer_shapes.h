// SPDX-License-Identifier: Apache-2.0
// Reads the scatterers of a layer from parameters, for the BSDF `correlated_scatterers`.
#pragma once

#include <vector>

#include "aureole/optics/layer/scatterer_mixture.h"
#include "aureole/plugin/properties.h"

namespace aureole {

/// The scatterers of a layer, with lengths in metres. `correlation_radius`: radius of the discs that keep
/// scatterers apart. `largest`: radius of the circumcircle of the largest scatterer.
struct LayerShapes {
  std::vector<optics::Scatterer> scatterers;
  double correlation_radius, largest;
};

/// Reads "radius" or the nested apertures, and "correlation_radius". Throws located Errors.
LayerShapes read_layer_shapes(const Properties& p);

}  // namespace aureole
