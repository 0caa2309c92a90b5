// SPDX-License-Identifier: Apache-2.0
// Maps of numbers in false colours, with isolines and a scale.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "aureole/core/image.h"

namespace aureole {

/// The scale of a map: a value is shown by its position between `min` and `max`, which is larger.
struct ColourScale {
  double min = 0, max = 1;
  std::vector<double> isolines;                        ///< values along which a line is drawn
  std::vector<std::pair<double, std::string>> labels;  ///< values with their text beside the scale
  std::string title;
};

/// Draws a map, row by row from the top, with a colour bar, its labels, and isolines (of the median over 3 x 3 cells):
/// 8-bit sRGB. Cells that are not finite are dark grey. A small map is enlarged.
Image false_colour_picture(const std::vector<double>& values, int width, int height,
                           const ColourScale& scale);

}  // namespace aureole
