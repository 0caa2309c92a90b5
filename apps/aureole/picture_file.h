// SPDX-License-Identifier: Apache-2.0
// Pictures that subcommands read and write.
#pragma once

#include <filesystem>
#include <string>

#include "aureole/core/image.h"

namespace aureole {

/// Reads a picture and prints assumptions made on reading its file.
Image read_picture(const std::string& file, ExrAttributes* attributes = nullptr);

/// Returns the default name of a scene's output: the scene's own name with another extension, in the working folder.
std::filesystem::path default_output(const std::filesystem::path& scene, const std::string& extension);

}  // namespace aureole
