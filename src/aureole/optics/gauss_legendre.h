// SPDX-License-Identifier: Apache-2.0
// Gauss-Legendre quadrature with any number of nodes.
#pragma once

#include <vector>

namespace aureole::optics {

struct Quadrature {
  std::vector<double> x, weight;
};

/// Returns `n` nodes in [from, to] in decreasing order, exact for polynomials of degree 2n - 1. Newton's
/// method starts from the asymptotic approximation of the zeros (Abramowitz & Stegun 1964, 22.16.6).
Quadrature gauss_legendre(int n, double from = -1, double to = 1);

}  // namespace aureole::optics
