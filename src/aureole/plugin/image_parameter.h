// SPDX-License-Identifier: Apache-2.0
// The picture of a plug-in: the file `filename`, or the numbers `data` that a program gives.
#pragma once

#include <limits>
#include <string>

#include "aureole/core/image.h"
#include "aureole/plugin/registry.h"

namespace aureole {

class Properties;

struct ImageParameter {
  Image image;
  std::string name;  ///< of the parameter it came from, for errors about its content
};

/// Throws located Errors: neither or both given, a file that cannot be read, more than `max_pixels`, an array
/// of another shape than height x width [x 1, 3 or 4].
ImageParameter read_image_parameter(const Properties& properties, std::size_t max_pixels = std::size_t(1)
                                                                                           << 30);

/// The rows of the parameter table.
ParameterDoc image_file_doc(const std::string& meaning);
ParameterDoc image_data_doc();

}  // namespace aureole
