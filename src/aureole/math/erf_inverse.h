// SPDX-License-Identifier: Apache-2.0
// The inverse of the error function, by which Gaussians are sampled between limits.
#pragma once

namespace aureole {

/// x of the density exp(-x^2) between two limits, of which `low` and `high` are the error functions; u in [0, 1).
double sample_between(double low, double high, double u);

}  // namespace aureole
