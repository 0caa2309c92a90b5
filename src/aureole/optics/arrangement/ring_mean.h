// SPDX-License-Identifier: Apache-2.0
// Means over rings |u| = constant of functions for which f(-u) is f(u) or its conjugate. The midpoint rule in
// the angle over half a ring is exact if there are more points than the order of the highest harmonic.
#pragma once

#include <cmath>
#include <numbers>

namespace aureole::optics {

/// Calls f(ux, uy) at `points` points of half the ring.
template <class F>
void visit_half_ring(double u, int points, F&& f) {
  for (int i = 0; i < points; ++i) {
    const double angle = std::numbers::pi * (i + 0.5) / points;
    f(u * std::cos(angle), u * std::sin(angle));
  }
}

/// Returns the mean of f(ux, uy) over the ring.
template <class F>
double ring_mean(double u, int points, F&& f) {
  double sum = 0;
  visit_half_ring(u, points, [&](double x, double y) { sum += f(x, y); });
  return sum / points;
}

}  // namespace aureole::optics
