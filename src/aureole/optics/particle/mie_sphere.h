// SPDX-License-Identifier: Apache-2.0
// Scattering of a plane wave by one homogeneous sphere (Mie theory), in the notation of Bohren & Huffman,
// Absorption and Scattering of Light by Small Particles, 1983, chapter 4. With the time dependence exp(-i
// omega t) the relative index m = n + i k of an absorbing sphere has k >= 0.
#pragma once

#include <complex>

#include "aureole/optics/particle/partial_waves.h"

namespace aureole::optics {

class Mie : public PartialWaves {
public:
  static constexpr double kMinSize = 1e-6, kMaxSize = 1e5;
  static constexpr double kMaxIndex = 100;  ///< upper bound of |m|; time and memory are proportional to |m|

  /// `x`: 2 pi radius n_medium/lambda. `m`: index of the sphere over that of the medium. Throws
  /// std::domain_error, with the value, unless x is in [kMinSize, kMaxSize], Re m > 0, Im m >= 0 and |m| <=
  /// kMaxIndex.
  Mie(double x, std::complex<double> m);
};

}  // namespace aureole::optics
