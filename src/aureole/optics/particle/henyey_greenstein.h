// SPDX-License-Identifier: Apache-2.0
// Henyey-Greenstein phase functions (Astrophys. J. 93 (1941) 70), single and double, and their fits to a
// tabulated phase function. The mean of the Legendre polynomial P_l is g^l.
#pragma once

#include "aureole/optics/particle/phase_table.h"

namespace aureole::optics {

/// Returns the phase function in 1/sr, with integral 1 over the sphere. Throws std::domain_error unless g is
/// in (-1, 1).
double henyey_greenstein(double mu, double g);

/// A mixture of `share` of g1 and 1 - `share` of g2; share in [0, 1], g1 >= g2.
struct DoubleHenyeyGreenstein {
  double share = 1, g1 = 0, g2 = 0;

  double eval(double mu) const;
  double asymmetry() const { return share * g1 + (1 - share) * g2; }
};

/// Returns the g that equals the table's mean cosine.
double fit_henyey_greenstein(const PhaseTable& phase);

/// Returns the mixture that has the table's means of P_1, P_2 and P_3 (Kattawar, J. Quant. Spectrosc. Radiat.
/// Transfer 15 (1975) 839). If there is none, it matches P_1 and approximates the other two by least squares.
DoubleHenyeyGreenstein fit_double_henyey_greenstein(const PhaseTable& phase);

}  // namespace aureole::optics
