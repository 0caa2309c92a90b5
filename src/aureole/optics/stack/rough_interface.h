// SPDX-License-Identifier: Apache-2.0
// Operators of a rough interface. Inside of the library only.
#pragma once

#include <vector>

#include "aureole/optics/stack/operators.h"
#include "aureole/optics/stack/plane_stack.h"

namespace aureole::optics {

/// By azimuthal mode, `modes` of them. The kernel is averaged over the ranges of both channels, so that lobes narrower than the step
/// between two of them keep their energy. What is then missing of a channel's flux is spread over all channels in proportion to
/// what they miss (reciprocal, and right for light that microfacets scatter more than once), and what is too much is taken away by
/// factors of each channel (Sinkhorn & Knopp 1967): energy is exact.
std::vector<Operators> rough_interface(const Channels& channels, double index_above, double index_below,
                                       const StackInterface& interface, int modes);

}  // namespace aureole::optics
