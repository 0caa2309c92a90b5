// SPDX-License-Identifier: Apache-2.0
// Messages to the user.
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <utility>

namespace aureole {

/// Prints to standard error. A print that fails, because of a closed pipe or a full disc, is ignored, since a
/// lost message must not end a rendering.
template <class... Values>
void tell(fmt::format_string<Values...> format, Values&&... values) {
  std::fputs(fmt::format(format, std::forward<Values>(values)...).c_str(), stderr);
}

}  // namespace aureole
