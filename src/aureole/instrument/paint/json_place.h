// SPDX-License-Identifier: Apache-2.0
// Line and column of a value in a JSON text, for the errors of readers that parse it by nlohmann-json, which keeps no places.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "aureole/core/error.h"

namespace aureole {

/// A step from a JSON value to one of its parts: the key of an object, or the index of an array.
using JsonStep = std::variant<std::string, std::size_t>;
using JsonPath = std::vector<JsonStep>;

/// A path as text, such as "samples[3].values[12]".
std::string json_path_text(const JsonPath& path);

/// Line and column, from 1, of the byte at `offset` of a text. Columns count characters of UTF-8.
SourceLocation place_of_byte(const std::string& file, std::string_view text, std::size_t offset);

/// Line and column at which the value of this path begins, in a text that a parser has accepted. For a path that the text does not
/// have, it is the place of the last part that exists.
SourceLocation json_place(const std::string& file, std::string_view text, const JsonPath& path);

}  // namespace aureole
