// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace aureole {

/// The largest value of a spectrum that a scene may state. Sums and products of larger floats become
/// infinite.
inline constexpr double kLargestSpectrumValue = 1e37;

}  // namespace aureole
