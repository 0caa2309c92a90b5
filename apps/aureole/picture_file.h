// SPDX-License-Identifier: Apache-2.0
// Pictures that are arguments of subcommands.
#pragma once

#include <string>

#include "aureole/core/image.h"

namespace aureole {

/// Reads a picture and prints how its file was understood, where that is not obvious.
Image read_picture(const std::string& file, ExrAttributes* attributes = nullptr);

}  // namespace aureole
