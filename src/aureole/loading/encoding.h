// SPDX-License-Identifier: Apache-2.0
// Converts XML files of other encodings to UTF-8 before they are parsed, so that positions in the text stay
// known.
#pragma once

#include <string>

namespace aureole {

/// Converts UTF-16, UTF-32 (detected by the byte order mark or the encoding of "<") and declared Latin-1 to
/// UTF-8. Other text is unchanged except that a byte order mark is removed.
std::string to_utf8(std::string text);

}  // namespace aureole
