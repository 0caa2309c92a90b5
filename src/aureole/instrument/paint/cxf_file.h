// SPDX-License-Identifier: Apache-2.0
// Measured samples in the Color Exchange Format, version 3 (ISO 17972-1) or 2, an XML format written by
// spectrophotometers and ink formulation programs.
#pragma once

#include <string>

#include "aureole/pigment/samples.h"

namespace aureole {

/// Reads all objects with a reflectance or transmittance spectrum. An object's name is the paint or its
/// recipe ("red: 1 + white: 3"). The tags PAINTS, SAMPLE, BACKING and THICKNESS_UM, in any case, have the
/// meaning of the columns of a table (pigment/samples.h). Geometry, specular component and aperture of the colour
/// specification become the table's instrument. Version 2 has the range of wavelengths in the colour specification
/// itself. Throws Error with line and column, also for samples of different geometries.
pigment::SampleTable read_cxf_file(const std::string& file);

}  // namespace aureole
