// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/particle/mie_sphere.h"

#include <stdexcept>
#include <string>

#include "aureole/optics/constants.h"
#include "aureole/optics/particle/riccati_bessel.h"

namespace aureole::optics {

Mie::Mie(double x, Complex m) : PartialWaves(x) {
  if (!(x >= kMinSize && x <= kMaxSize))
    throw std::domain_error("size parameter of a sphere must be in [1e-6, 1e5], got " + std::to_string(x));
  if (!(m.real() > 0 && m.imag() >= 0 && std::abs(m) <= kMaxIndex))
    throw std::domain_error(
        "relative index of a sphere must have a positive real part, no negative imaginary part and a modulus "
        "up to 100, got " +
        std::to_string(m.real()) + " + " + std::to_string(m.imag()) + "i");
  const int count = term_count(x);
  std::vector<Complex> electric = logarithmic_derivatives(m * x, count), magnetic = electric;
  const Complex per_m = 1.0 / m;
  for (int n = 1; n <= count; ++n) electric[n] *= per_m, magnetic[n] *= m;
  match(electric, magnetic);
}

}  // namespace aureole::optics
