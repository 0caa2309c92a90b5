// SPDX-License-Identifier: Apache-2.0
// Henyey and Greenstein's phase functions (Astrophys. J. 93 (1941) 70), one and two of them, fitted to another.
// Their means of Legendre's polynomials P_l are g^l.
#pragma once

#include "aureole/optics/particle/phase_table.h"

namespace aureole::optics {

/// 1/sr, integral 1 over the sphere, g in (-1, 1). Throws std::domain_error.
double henyey_greenstein(double mu, double g);

/// share of g1 and 1 - share of g2; share in [0, 1], g1 >= g2.
struct DoubleHenyeyGreenstein {
  double share = 1, g1 = 0, g2 = 0;

  double eval(double mu) const;
  double asymmetry() const { return share * g1 + (1 - share) * g2; }
};

/// The g with the same mean cosine: that of the table.
double fit_henyey_greenstein(const PhaseTable& phase);

/// The mixture with the same means of P_1, P_2 and P_3 (Kattawar, J. Quant. Spectrosc. Radiat. Transfer 15 (1975)
/// 839), or where there is none, with the same P_1 and the nearest two others, by least squares.
DoubleHenyeyGreenstein fit_double_henyey_greenstein(const PhaseTable& phase);

}  // namespace aureole::optics
