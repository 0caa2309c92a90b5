// SPDX-License-Identifier: Apache-2.0
// Reads shapes of SVG files as polygons.
#pragma once

#include <filesystem>
#include <vector>

#include "aureole/optics/aperture/polygon_region.h"

namespace aureole {

/// Maximum distance of a curve from its polygon, relative to the larger side of the picture's bounding box.
inline constexpr double kSvgTolerance = 1e-4;

/// Returns the outlines of all path, polygon, polyline, rect, circle and ellipse elements, one ring per
/// closed subpath, with y upward. Throws an Error that names the invalid element and the reason.
std::vector<optics::Ring> read_svg_rings(const std::filesystem::path& file);

}  // namespace aureole
