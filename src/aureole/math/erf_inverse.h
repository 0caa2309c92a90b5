// SPDX-License-Identifier: Apache-2.0
// The inverse of the error function, by which Gaussians are sampled between limits.
#pragma once

namespace aureole {

/// For -1 < x < 1.
double erf_inverse(double x);

}  // namespace aureole
