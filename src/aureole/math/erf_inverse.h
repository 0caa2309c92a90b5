// SPDX-License-Identifier: Apache-2.0
// Samples a Gaussian between two limits by inverting the error function.
#pragma once

namespace aureole {

/// Samples x in proportion to exp(-x^2) between two limits, given by their error functions `low` and `high`;
/// u is in [0, 1).
double sample_between(double low, double high, double u);

}  // namespace aureole
