// SPDX-License-Identifier: Apache-2.0
// Powers of edge-diffracted waves: how much light the edges of a region diffract, alone and together. Powers are
// integrals over q of |F|^2/(4 pi^2) (edge_wave.h), amplitude^2 x area.
#pragma once

#include <span>

#include "aureole/optics/diffraction/edge_wave.h"
#include "aureole/optics/diffraction/triangle_transform.h"

namespace aureole::optics {

/// Integrals over the plane of (1 - chi) alpha_1^2 and (1 - chi) alpha_2^2; that of alpha_1 alpha_2 is 0.
struct EdgeConstants {
  double alpha1, alpha2;
};
/// In closed form, chi of standard deviation `canonical_sigma` in canonical coordinates. At sqrt(3), the published
/// chi, they are 0.00461271 and 0.12458991 (Steinberg et al. 2024 print 0.00452551 and 0.11487543 in S2.36, which
/// quadrature does not confirm). At 0, where nothing is removed, 1/(64 pi) and infinity.
EdgeConstants edge_constants(double canonical_sigma);

/// Power diffracted by one edge, without interference: length^2 (|a - b|^2 alpha1 + |(a + b)/2|^2 alpha2), the two
/// terms apart (S2.33; the term of both has the integral 0).
struct EdgePower {
  double alpha1 = 0, alpha2 = 0;
  double total() const { return alpha1 + alpha2; }
};
EdgePower edge_power(const DiffractingEdge& edge, ZerothOrder zeroth);

/// Power diffracted by edges together, with interference, to all q, after one chi of standard deviation `sigma` is
/// removed. The integral over q is closed: it leaves two integrals along edges over
///   integral of (1 - chi) q_a q_b/q^4 exp(-i q.r) d2q = pi/2 [(E1(u) + h(u)) delta_ab - 2 h(u) r_a r_b/r^2],
/// u = (sigma r)^2/2, h(u) = (1 - exp(-u))/u, E1 the exponential integral; by Gauss's rule with `nodes` (2, 4 or 8)
/// for an edge of length up to 1/sigma and more in proportion. No allocation. With 2 nodes the error is some 1 %,
/// with 8 below 1e-4, for edges that are no closer to one another than the nodes are.
double interfering_power(std::span<const DiffractingEdge> edges, double sigma, int nodes = 4);

/// The same by quadrature over q < q_max for any removal: 2 k where all real directions are meant. Steps follow the
/// extent of the edges, six to a fringe; error some 1e-3. The field must be finite at 0: closed rings, or a lobe removed.
double diffracted_power(std::span<const DiffractingEdge> edges, ZerothOrder zeroth, double q_max);

/// Power in the 0th order by the peak's height and curvature (their B.16): 2 pi |F(0)|^2/(4 pi^2) det(H + 1/sigma^2)^-1/2,
/// H = -d2 ln |F|^2 at q = 0, from the moments of the amplitude, the centroid's included. `sigma` is that of chi.
/// Throws std::domain_error where nothing comes straight ahead, F(0) = 0.
double zeroth_order_power(std::span<const LinearTriangle> triangles, double sigma);
/// Their B.15 for chi of each edge: sqrt(3) over the edges' mean length, weighted by power.
double mean_edge_sigma(std::span<const DiffractingEdge> edges);

}  // namespace aureole::optics
