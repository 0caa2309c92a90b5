// SPDX-License-Identifier: Apache-2.0
// Encodings of XML files other than UTF-8. They are undone before the file is parsed, so that places in the
// text stay known.
#pragma once

#include <string>

namespace aureole {

/// UTF-16, UTF-32 (by byte order mark, or by how "<" is written) and declared Latin-1 as UTF-8; anything else
/// as it is, without a byte order mark.
std::string to_utf8(std::string text);

}  // namespace aureole
