// SPDX-License-Identifier: Apache-2.0
// The kernel K of edge_kernel.h on the edges of a group that lies within about one beam, such as those of a small hole: all their waves are
// summed at once.
#pragma once

#include <span>
#include <vector>

#include "aureole/optics/diffraction/edge_kernel.h"
#include "aureole/optics/lanes.h"

namespace aureole::optics {

/// K on an edge of a group that lies within about one beam, by a drawn wave vector, in a time that grows with the number of edges and not
/// with that of their pairs: coherence exp(-r^2/(8 sigma^2)) is the mean of cos(s.r) over wave vectors s with the standard deviation
/// 1/(2 sigma), so that with one of these
///   K = (k/2 pi)^2 (1 - chi)/q^4 W |sum over edges of (m_l.q) integral exp(i (q + s).x') dl'|^2,   W = w_j/(sum of w_l length_l),
/// w_j = (m_j.q)^2 for the normal m_j per length in space: what all edges send, divided among them by the light that each would send alone.
/// Summed over the edges it has the mean that `mean_edge_kernel` has, and it is never negative. `index`: of the edge; `normal`: two independent numbers of the standard normal distribution, which are s
/// times 2 sigma; the rest as above. Where all wavelengths have nearly the same phases over 14 sigma one stands for all.
void drawn_edge_kernels(std::span<const ProjectedEdge> edges, std::size_t index, PlanePoint normal,
                        double turn, std::span<const double> k, std::span<const double> sigma,
                        std::span<double> result);

/// Edges in space that are asked for `drawn_edge_kernels` again and again, laid out so that four are projected at once.
class EdgeGroup {
public:
  /// Of a surface, or of a fold between two: seen from the side of the normal n0 the first one lies to the left of the way from a to b. n1 is
  /// that of the second one, away from the same side, and 0 where there is none.
  struct Edge {
    SpaceVector a, b, n0, n1;
  };
  explicit EdgeGroup(std::span<const Edge> edges);
  bool empty() const { return fours_.empty(); }

  /// `drawn_edge_kernels` of those edges that are outlines in light along `d`, projected along that with the light's turn along `x`; both are
  /// unit vectors across each other. 0 for an edge that is none. No allocation.
  void drawn_kernels(std::size_t index, SpaceVector d, SpaceVector x, PlanePoint normal, double turn,
                     std::span<const double> k, std::span<const double> sigma,
                     std::span<double> result) const;

private:
  struct Four {
    Lanes half[3], middle[3], n0[3], n1[3], inverse_length;
  };
  std::vector<Four> fours_;  ///< what is left of four has no length
};

}  // namespace aureole::optics
