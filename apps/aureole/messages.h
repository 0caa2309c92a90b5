// SPDX-License-Identifier: Apache-2.0
// Messages to the user.
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <utility>

namespace aureole {

/// Prints to standard error. Where that cannot be written, a closed pipe or a full disc, the work goes on: a message
/// that nobody gets must not cost a picture.
template <class... Values>
void tell(fmt::format_string<Values...> format, Values&&... values) {
  std::fputs(fmt::format(format, std::forward<Values>(values)...).c_str(), stderr);
}

}  // namespace aureole
