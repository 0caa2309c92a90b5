// SPDX-License-Identifier: Apache-2.0
// A check of the header of an EXR file before a library allocates memory by it.
#pragma once

#include <cstddef>
#include <span>

namespace aureole::codec {

/// Walks over the attributes of all headers of the file; throws Error where one does not fit into the file,
/// where a data window exceeds `max_pixels`, or where no file of this size can hold the pixels or tiles
/// promised.
void check_exr_header(std::span<const unsigned char> bytes, std::size_t max_pixels);

}  // namespace aureole::codec
