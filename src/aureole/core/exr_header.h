// SPDX-License-Identifier: Apache-2.0
// Checks the header of an EXR file before a library allocates memory based on it.
#pragma once

#include <cstddef>
#include <span>

namespace aureole::codec {

/// Checks the attributes of all headers of the file. Throws Error if one does not fit into the file, if a
/// data window exceeds `max_pixels`, or if a file of this size cannot contain the stated number of pixels or
/// tiles. Returns the number of parts.
int check_exr_header(std::span<const unsigned char> bytes, std::size_t max_pixels);

}  // namespace aureole::codec
