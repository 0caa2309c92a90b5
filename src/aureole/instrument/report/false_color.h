// SPDX-License-Identifier: Apache-2.0
// Pictures of scalar data: colours of a named map, with contours and a labelled scale beside them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "aureole/core/image.h"

namespace aureole {

/// The mapping of numbers to colours.
struct ColorScale {
  double low = 0, high = 1;     ///< numbers of the first and the last colour, which are also used beyond them
  bool is_logarithmic = false;  ///< colours are in proportion to the logarithm; `low` is then above 0
  std::string map = "viridis";  ///< one of `color_scale_maps`
  std::string title{};          ///< quantity and unit, written above the picture
  std::vector<double> contours{};  ///< numbers at which white lines are drawn
};

/// Names of the maps, for messages and options.
const std::vector<std::string>& color_scale_maps();

/// Returns round numbers for the labels of a scale, seven at most.
std::vector<double> scale_labels(const ColorScale& scale);

/// Draws height x width numbers, row by row from the top. Cells become squares of whole pixels, so that the longer side has
/// about `side` pixels, or one pixel where the picture is larger than that. Numbers that are not finite are dark grey, as
/// are those at or below 0 on a logarithmic scale. Contours follow the numbers without outliers: the median of 3 x 3 cells.
/// Returns R, G, B encoded for display. Throws Error for scales that do not rise or an unknown map.
Image false_color_picture(std::span<const double> values, int width, int height, const ColorScale& scale,
                          int side = 640);

}  // namespace aureole
