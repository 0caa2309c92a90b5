// SPDX-License-Identifier: Apache-2.0
// Powers of edge-diffracted waves: the power that the edges of a region diffract, each alone and all
// together. Powers are integrals over q of |F|^2/(4 pi^2) (edge_wave.h), amplitude^2 x area.
#pragma once

#include <span>

#include "aureole/optics/diffraction/edge_wave.h"
#include "aureole/optics/diffraction/triangle_transform.h"

namespace aureole::optics {

/// Integrals over the plane of (1 - chi) alpha_1^2 and of (1 - chi) alpha_2^2; the integral of alpha_1
/// alpha_2 is 0.
struct EdgeConstants {
  double alpha1, alpha2;
};
/// Returns the constants in closed form, for chi of standard deviation `canonical_sigma` in canonical
/// coordinates. At sqrt(3), the published chi, they are 0.00461271 and 0.12458991 (Steinberg et al. 2024
/// print 0.00452551 and 0.11487543 in S2.36, which quadrature does not confirm). At 0, where nothing is
/// removed, they are 1/(64 pi) and infinity.
EdgeConstants edge_constants(double canonical_sigma);

/// Power diffracted by one edge, without interference: length^2 (|a - b|^2 alpha1 + |(a + b)/2|^2 alpha2),
/// the two terms separately (S2.33). The integral of the mixed term is 0.
struct EdgePower {
  double alpha1 = 0, alpha2 = 0;
  double total() const { return alpha1 + alpha2; }
};
EdgePower edge_power(const DiffractingEdge& edge, ZerothOrder zeroth);

/// Returns the power that the edges diffract together, with interference, into all q, after removal of one
/// chi of standard deviation `sigma`. The integral over q has a closed form, which leaves two integrals along
/// edges over
///   integral of (1 - chi) q_a q_b/q^4 exp(-i q.r) d2q = pi/2 [(E1(u) + h(u)) delta_ab - 2 h(u) r_a r_b/r^2],
/// where u = (sigma r)^2/2, h(u) = (1 - exp(-u))/u and E1 is the exponential integral. They are evaluated by
/// Gauss rules with `nodes` (2, 4 or 8) for a length of edge up to 1/sigma, and proportionally more for
/// longer ones. No allocation. With 2 nodes the error is about 1 %, with 8 below 1e-4, for edges no closer to
/// one another than the nodes are.
double interfering_power(std::span<const DiffractingEdge> edges, double sigma, int nodes = 4);

/// Returns the power by quadrature over |q| < q_max, for any removal of the 0th order; q_max = 2 k includes
/// all real directions. Steps follow the extent of the edges, six to a fringe; the error is about 1e-3. The
/// field must be finite at q = 0: the edges are closed rings, or a 0th order is removed.
double diffracted_power(std::span<const DiffractingEdge> edges, ZerothOrder zeroth, double q_max);

/// Returns the power of the 0th order by the peak's height and curvature (Steinberg et al., B.16): 2 pi
/// |F(0)|^2/(4 pi^2) det(H + 1/sigma^2)^-1/2, where H = -d2 ln |F|^2 at q = 0 follows from the moments of the
/// amplitude, those of first order included. `sigma` is that of chi. Throws std::domain_error if F(0) = 0.
double zeroth_order_power(std::span<const LinearTriangle> triangles, double sigma);
/// Returns sigma of chi for each edge (their B.15): sqrt(3) over the mean length of the edges, weighted by
/// power.
double mean_edge_sigma(std::span<const DiffractingEdge> edges);

}  // namespace aureole::optics
