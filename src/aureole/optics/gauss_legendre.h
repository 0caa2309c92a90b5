// SPDX-License-Identifier: Apache-2.0
// Gauss and Legendre's quadrature with any number of nodes.
#pragma once

#include <vector>

namespace aureole::optics {

struct Quadrature {
  std::vector<double> x, weight;
};

/// `n` nodes in [from, to], from the last to the first: exact for polynomials of degree 2n - 1. Newton's method from the
/// asymptotic places of the zeros (Abramowitz & Stegun 1964, 22.16.6).
Quadrature gauss_legendre(int n, double from = -1, double to = 1);

}  // namespace aureole::optics
