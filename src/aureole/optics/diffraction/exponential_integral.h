// SPDX-License-Identifier: Apache-2.0
// The exponential integral, with which beams of Gaussian coherence sum the light of edges.
#pragma once

namespace aureole::optics {

/// E1(u), the integral of exp(-t)/t from u > 0 on.
double exponential_integral(double u);
/// Ein(u) = gamma + ln(u) + E1(u), which is entire: also for u <= 0.
double entire_exponential_integral(double u);

}  // namespace aureole::optics
