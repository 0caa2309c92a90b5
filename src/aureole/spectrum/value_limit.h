// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace aureole {

/// The largest value of a spectrum that a scene may state. Values are floats, and become infinite in sums and
/// products of larger ones.
inline constexpr double kLargestSpectrumValue = 1e37;

}  // namespace aureole
