// SPDX-License-Identifier: Apache-2.0
// The picture of a plug-in: the file `filename`, or the array `data` that a program passes in memory.
#pragma once

#include <limits>
#include <string>
#include <string_view>

#include "aureole/core/image.h"
#include "aureole/plugin/registry.h"

namespace aureole {

class Properties;

struct ImageParameter {
  Image image;
  std::string name;  ///< name of the parameter that gave the picture, for errors about its content
};

/// Reads the picture, and notes assumptions about its file. Throws an Error located at the parameter if
/// neither or both are given, if the file cannot be read, for more than `max_pixels`, or for an array whose
/// shape is not height x width [x 1, 3 or 4].
ImageParameter read_image_parameter(const Properties& properties, ImageColors colors = ImageColors::srgb,
                                    std::size_t max_pixels = std::size_t(1) << 30);

enum class PixelRange { any, not_negative, radiance };

/// Makes bad pixels of R, G, B or Y harmless, with notes at the parameter `name`: NaN becomes 0, infinity the
/// largest finite value, and negative values become 0 where they are radiances, or few (see kNegativePart);
/// elsewhere the caller judges them. Throws Error if more than one pixel in a hundred is not finite.
/// Returns false if no value is negative any more.
bool mend_pixels(const Properties& properties, std::string_view name, Image& image, PixelRange range);

/// Returns the rows of the parameter table for `filename` and `data`.
ParameterDoc image_file_doc(const std::string& meaning);
ParameterDoc image_data_doc();

}  // namespace aureole
