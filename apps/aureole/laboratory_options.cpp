// SPDX-License-Identifier: Apache-2.0
#include "laboratory_options.h"

#include <fmt/format.h>

#include "aureole/core/error.h"
#include "aureole/core/units.h"

namespace aureole {

void set_length(const char* option, const std::string& text, double& metres) {
  if (text.empty()) return;
  try {
    metres = parse_length_m(text);
  } catch (const Error& e) {
    throw Error(fmt::format("{} {}: {}", option, text, e.message()));
  }
}

}  // namespace aureole
