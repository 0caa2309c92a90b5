// SPDX-License-Identifier: Apache-2.0
// Shapes of SVG files as polygons.
#pragma once

#include <filesystem>
#include <vector>

#include "aureole/optics/aperture/polygon_region.h"

namespace aureole {

/// Greatest distance of a curve from its polygon, relative to the larger side of the picture's bounding box.
inline constexpr double kSvgTolerance = 1e-4;

/// The outlines of all path, polygon, polyline, rect, circle and ellipse elements, one ring per closed
/// subpath, with y upwards. Throws Error that says which element is wrong, and how.
std::vector<optics::Ring> read_svg_rings(const std::filesystem::path& file);

}  // namespace aureole
