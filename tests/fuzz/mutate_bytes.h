// SPDX-License-Identifier: Apache-2.0
// Changes to files as bytes and as lines of text: scene files that are no XML any more, damaged meshes and
// images.
#pragma once

#include <string>

#include "fuzz/fuzz_random.h"

namespace aureole::fuzz {

/// Bytes changed, removed, repeated or inserted; words swapped or replaced; the end cut off; another
/// encoding.
std::string mutate_text(std::string text, Random& random);

/// Damages a file by what its content is: a mesh or spectrum as text, a .serialized mesh inside its
/// compressed stream, a PNG with its checksums kept right, anything else as bytes and numbers of a header.
std::string mutate_data(const std::string& bytes, Random& random);

}  // namespace aureole::fuzz
