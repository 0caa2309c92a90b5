// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aureole/bsdf/bsdf.h"

namespace aureole {

/// A flag of `lobes()` beside those of `Lobe`: light that meets a fibre leaves it where it came, also on the far
/// side. Which part of the fibre's width it meets is taken from `wi` in both modes, so that values are no adjoints of
/// each other, and a path through the fibre cannot be walked backwards: that walk would meet its other side.
inline constexpr Lobe kNearField = Lobe(256);

}  // namespace aureole
