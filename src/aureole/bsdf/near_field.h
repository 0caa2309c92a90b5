// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aureole/bsdf/bsdf.h"

namespace aureole {

/// A flag of `lobes()` in addition to those of `Lobe`: all scattering by a fibre happens at one point, also
/// for light that leaves on the far side. The offset across the fibre's width is taken from `wi` in both
/// modes. Values are therefore not adjoint, and a path through the fibre cannot be traced backward: it would
/// hit the other side.
inline constexpr Lobe kNearField = Lobe(256);

}  // namespace aureole
