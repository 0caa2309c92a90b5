// SPDX-License-Identifier: Apache-2.0
// Sorting by depth.
#pragma once

#include <cstdint>
#include <span>

#include "aureole/core/unfilled.h"

namespace aureole {

/// Returns the indices of positive depths from the smallest to the largest; equal depths keep their order. On all cores.
UnfilledVector<std::uint32_t> sort_by_depth(std::span<const float> depths);

}  // namespace aureole
