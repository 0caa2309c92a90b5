// SPDX-License-Identifier: Apache-2.0
// The wavelength range of a scene's sensor, read from its nodes before any object is built.
#pragma once

#include "aureole/loading/references.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

/// Returns the grid for the first sensor's film: wavelength_min and wavelength_max; else the range that the
/// film's plug-in derives from its parameters (PluginInfo::wavelength_range); else the visible range.
SpectralGrid sensor_grid(const References& references, Diagnostics& diagnostics);

}  // namespace aureole
