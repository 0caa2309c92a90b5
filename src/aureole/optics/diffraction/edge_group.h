// SPDX-License-Identifier: Apache-2.0
// The diffraction coefficient K of edge_kernel.h on the edges of a group that lies within about one beam,
// such as those of a small hole: all their waves are summed at once.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "aureole/optics/diffraction/edge_kernel.h"
#include "aureole/optics/lanes.h"

namespace aureole::optics {

/// Evaluates K, by a random wave vector, on an edge of a group that lies within about one beam. The time
/// grows with the number of edges and not with the number of pairs. The coherence exp(-r^2/(8 sigma^2)) is
/// the mean of cos(s.r) over wave vectors s with standard deviation 1/(2 sigma), so that one such s gives
///   K = (k/2 pi)^2 (1 - chi)/q^4 W |sum over edges of (m_l.q) integral exp(i (q + s).x') dl'|^2,   W = w_j/(sum of w_l length_l),
/// w_j = (m_j.q)^2 for the normal m_j per length in space. W divides the power that all edges diffract among
/// them by the power that each would diffract alone. Summed over the edges, K has the mean of
/// `mean_edge_kernel`, and it is never negative. `index` is the number of the edge; `normal` holds two
/// independent standard normal numbers, s times 2 sigma; the other parameters are those of
/// `mean_edge_kernels`. If all wavelengths have nearly the same phases over 14 sigma, one is computed for
/// all.
void drawn_edge_kernels(std::span<const ProjectedEdge> edges, std::size_t index, PlanePoint normal,
                        double turn, std::span<const double> k, std::span<const double> sigma,
                        std::span<double> result);

/// Edges in space for repeated evaluation of `drawn_edge_kernels`, laid out so that four are projected at
/// once.
class EdgeGroup {
public:
  /// An edge of a surface, or of a fold between two surfaces. Seen from the side of the normal n0, the first
  /// surface lies to the left of the direction from a to b. n1 is the normal of the second surface, on the
  /// same side, and 0 if there is none.
  struct Edge {
    SpaceVector a, b, n0, n1;
  };
  explicit EdgeGroup(std::span<const Edge> edges);

  /// Evaluates `drawn_edge_kernels` for the edges that are outlines in light along `d`, projected along `d`
  /// with the change of the light's direction along `x`; `d` and `x` are perpendicular unit vectors. The
  /// result is 0 for an edge that is no outline. No allocation.
  void drawn_kernels(std::size_t index, SpaceVector d, SpaceVector x, PlanePoint normal, double turn,
                     std::span<const double> k, std::span<const double> sigma,
                     std::span<double> result) const;

  struct Choice {
    std::size_t index;
    double probability;
  };
  /// Samples an edge in proportion to an estimate of the power that it diffracts: with probability 3/4 to its
  /// share in `drawn_edge_kernels`, else to its length. Light along `d` turns about the axis `y`; they are
  /// perpendicular unit vectors. u is in [0, 1).
  Choice choose(SpaceVector d, SpaceVector y, double u) const;
  /// Samples an edge in proportion to its length, leaving out the edge `without` (`kNone`: no edge). Empty if
  /// no length remains.
  static constexpr std::size_t kNone = ~std::size_t(0);
  std::optional<Choice> choose_by_length(double u, std::size_t without = kNone) const;

private:
  struct Four {
    Lanes half[3], middle[3], n0[3], n1[3], length, inverse_length;
  };
  /// 1, or 0 for an edge that is no outline in light along d.
  Lanes outline(const Four& four, SpaceVector d) const;
  /// Returns each edge's relative power times its length, for light along `d` that turns about the axis `y`.
  Lanes light(const Four& four, SpaceVector d, SpaceVector y) const;
  /// Samples an edge in proportion to weight(four) -> Lanes, whose sum over all edges is `all`.
  template <class Weight>
  Choice choose_by(const Weight& weight, double all, double u) const;

  std::vector<Four> fours_;  ///< unused lanes have length 0
  double length_ = 0;        ///< length of all edges
  bool has_folds_ = false;
};

}  // namespace aureole::optics
