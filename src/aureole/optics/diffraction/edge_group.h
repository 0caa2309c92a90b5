// SPDX-License-Identifier: Apache-2.0
// The kernel K of edge_kernel.h on the edges of a group that lies within about one beam, such as those of a small hole: all their waves are
// summed at once.
#pragma once

#include <optional>
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
/// Summed over the edges it has the mean that `mean_edge_kernel` has, and it is never negative. `index`: of the edge; `normal`: two
/// independent numbers of the standard normal distribution, which are s times 2 sigma; the rest as in `mean_edge_kernels`. Where all wavelengths have nearly the same phases over 14 sigma one stands for all.
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

  /// `drawn_edge_kernels` of those edges that are outlines in light along `d`, projected along that with the light's turn along `x`; both are
  /// unit vectors across each other. 0 for an edge that is none. No allocation.
  void drawn_kernels(std::size_t index, SpaceVector d, SpaceVector x, PlanePoint normal, double turn,
                     std::span<const double> k, std::span<const double> sigma,
                     std::span<double> result) const;

  struct Choice {
    std::size_t index;
    double probability;
  };
  /// An edge in proportion to about the light that it sends where light along `d` turns across `y`, unit vectors across each other: in three
  /// of four cases to its share in `drawn_edge_kernels`, else to its length. u in [0, 1).
  Choice choose(SpaceVector d, SpaceVector y, double u) const;
  /// In proportion to their lengths, without the one of that number (or none, `kNone`); nothing where no length is left.
  static constexpr std::size_t kNone = ~std::size_t(0);
  std::optional<Choice> choose_by_length(double u, std::size_t without = kNone) const;

private:
  struct Four {
    Lanes half[3], middle[3], n0[3], n1[3], length, inverse_length;
  };
  /// 1, or 0 where an edge is no outline in light along d.
  Lanes outline(const Four& four, SpaceVector d) const;
  /// Each edge's part of the light times its length, over the sum for all; `y` is across the turn.
  Lanes light(const Four& four, SpaceVector d, SpaceVector y) const;
  /// In proportion to weight(four) -> Lanes, whose sum is `all`.
  template <class Weight>
  Choice choose_by(const Weight& weight, double all, double u) const;

  std::vector<Four> fours_;  ///< what is left of four has no length
  double length_ = 0;        ///< of all edges
  bool has_folds_ = false;
};

}  // namespace aureole::optics
