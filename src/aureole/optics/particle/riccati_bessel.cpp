// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/particle/riccati_bessel.h"

#include <algorithm>
#include <cmath>

#include "aureole/optics/constants.h"

namespace aureole::optics {

int term_count(double x) { return int(std::ceil(x + 4.05 * std::cbrt(x) + 8)); }

std::vector<Complex> logarithmic_derivatives(Complex z, int count) {
  const double size = std::abs(z);
  const int start = std::max(count, int(std::ceil(size + 8 * std::cbrt(size)))) + 16;
  std::vector<Complex> d(count + 1);
  const Complex inverse = 1.0 / z;
  const double ir = inverse.real(), ii = inverse.imag();
  double vr = (start + 1) * ir, vi = (start + 1) * ii;
  for (int n = start; n > 0; --n) {
    if (n <= count) d[n] = {vr, vi};
    const double rr = n * ir, ri = n * ii, sr = vr + rr, si = vi + ri, scale = 1 / (sr * sr + si * si);
    vr = rr - sr * scale, vi = ri + si * scale;
  }
  d[0] = {vr, vi};
  return d;
}

std::vector<double> riccati_bessel(double x, int count) {
  std::vector<double> psi(count + 1);
  const int turn = std::min(count, int(x));
  psi[0] = std::sin(x);
  double before = std::cos(x);
  for (int n = 1; n <= turn; ++n) {
    psi[n] = (2 * n - 1) / x * psi[n - 1] - before;
    before = psi[n - 1];
  }
  double ratio = 0;
  for (int n = count + 16 + int(4 * std::cbrt(x)); n > turn; --n) {
    ratio = 1 / ((2 * n + 1) / x - ratio);
    if (n <= count) psi[n] = ratio;
  }
  for (int n = turn + 1; n <= count; ++n) psi[n] *= psi[n - 1];
  return psi;
}

}  // namespace aureole::optics
