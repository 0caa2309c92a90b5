// SPDX-License-Identifier: Apache-2.0
// The exponential integral, which appears in sums of edge waves in beams of Gaussian coherence.
#pragma once

namespace aureole::optics {

/// Returns E1(u), the integral of exp(-t)/t from u > 0 to infinity.
double exponential_integral(double u);
/// Returns Ein(u) = gamma + ln(u) + E1(u), an entire function, also for u <= 0.
double entire_exponential_integral(double u);

}  // namespace aureole::optics
