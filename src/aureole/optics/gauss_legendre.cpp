// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/gauss_legendre.h"

#include <cmath>
#include <numbers>

namespace aureole::optics {

Quadrature gauss_legendre(int n, double from, double to) {
  Quadrature q;
  q.x.resize(n), q.weight.resize(n);
  const double middle = 0.5 * (from + to), half = 0.5 * (to - from);
  for (int i = 0; 2 * i < n; ++i) {
    double z = 2 * i + 1 == n ? 0 : std::cos(std::numbers::pi * (i + 0.75) / (n + 0.5)), slope = 0;
    for (int iteration = 0; iteration < 50; ++iteration) {
      double p = 1, before = 0;
      for (int k = 0; k < n; ++k) {
        const double next = ((2 * k + 1) * z * p - k * before) / (k + 1);
        before = p, p = next;
      }
      slope = n * (z * p - before) / (z * z - 1);
      const double step = p / slope;
      z -= step;
      if (std::abs(step) < 1e-15) break;
    }
    q.x[i] = middle + half * z;
    q.x[n - 1 - i] = middle - half * z;
    q.weight[i] = q.weight[n - 1 - i] = half * (2 / ((1 - z * z) * slope * slope));
  }
  return q;
}

}  // namespace aureole::optics
