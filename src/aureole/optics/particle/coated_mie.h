// SPDX-License-Identifier: Apache-2.0
// Scattering of a plane wave by a sphere with a concentric coat (Aden & Kerker 1951; Bohren & Huffman,
// Absorption and Scattering of Light by Small Particles, 1983, chapter 8).
#pragma once

#include <complex>

#include "aureole/optics/particle/partial_waves.h"

namespace aureole::optics {

class CoatedMie : public PartialWaves {
public:
  /// `core_x` and `x` are the size parameters 2 pi radius n_medium/lambda of the core and of the whole
  /// sphere. `core` and `coat` are indices relative to the medium. The algorithm uses only logarithmic
  /// derivatives and ratios, so thick absorbing coats do not overflow (Yang, "Improved recursive algorithm
  /// for light scattering by a multilayered sphere", Applied Optics 42 (2003) 1710). Throws
  /// std::domain_error, with the value, unless 0 < core_x <= x and x and both indices are in the range of
  /// `Mie`.
  CoatedMie(double core_x, double x, std::complex<double> core, std::complex<double> coat);
};

}  // namespace aureole::optics
