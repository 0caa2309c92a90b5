// SPDX-License-Identifier: Apache-2.0
// The wavelengths that a scene's sensor sees, read from its nodes before any object is built.
#pragma once

#include "aureole/scene/resolve.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

/// The range of the first sensor's film: wavelength_min and wavelength_max; else, of a spectral film, that of
/// its responses or bins; else the visible.
SpectralGrid sensor_grid(Node& root, const References& references, Diagnostics& diagnostics);

/// The first sensor in the file, which may sit on a shape, following references, or null.
Node* first_sensor(Node& root);

}  // namespace aureole
