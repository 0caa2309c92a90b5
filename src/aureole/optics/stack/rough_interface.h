// SPDX-License-Identifier: Apache-2.0
// Operators of a rough interface, internal to the library.
#pragma once

#include <vector>

#include "aureole/optics/stack/operators.h"
#include "aureole/optics/stack/plane_stack.h"

namespace aureole::optics {

/// Returns the operators of `modes` azimuthal modes. The kernel is averaged over the ranges of both channels,
/// so that lobes narrower than the channel spacing keep their energy. A channel's missing flux is distributed
/// over all channels in proportion to the missing flux of each. This is reciprocal and represents multiple
/// scattering between microfacets. An excess is removed by a factor for each channel (Sinkhorn & Knopp 1967),
/// so that energy is exact.
std::vector<Operators> rough_interface(const Channels& channels, double index_above, double index_below,
                                       const StackInterface& interface, int modes);

}  // namespace aureole::optics
