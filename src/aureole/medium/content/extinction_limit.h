// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <string_view>

#include "aureole/plugin/properties.h"

namespace aureole {

/// Throws an error at `parameter` where an extinction [per unit of length] is too large to be computed with: far
/// beyond the limit, products with lengths overflow. NaN is too large.
inline void require_computable_extinction(const Properties& p, std::string_view parameter,
                                          double extinction) {
  constexpr double kMost = 1e18;
  if (!(extinction <= kMost))
    throw p.error(parameter,
                  fmt::format("the extinction becomes {:.3g}; {:g} per unit of length are possible",
                              extinction, kMost));
}

}  // namespace aureole
