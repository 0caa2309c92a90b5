// SPDX-License-Identifier: Apache-2.0
// `UnfoldedPath`: the legs of a path between planar mirrors as one straight segment. Unfolded space is the space of
// the first leg, into which everything behind each mirror is reflected.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

#include "aureole/scene/edge/outline_edges.h"
#include "aureole/transport/segment_chain.h"

namespace aureole {

class UnfoldedPath {
public:
  /// `begins_at_infinity`: light comes from infinity along the first leg. Such a path is reversed: it begins at the
  /// last leg's end.
  UnfoldedPath(std::span<const PathLeg> legs, bool begins_at_infinity);

  std::size_t size() const { return count_; }
  /// Whether all legs are unoccluded.
  bool is_open() const { return is_open_; }
  /// Returns the unfolded path.
  const EdgeSegment& segment() const { return segment_; }
  /// Returns the path as it is straight in the space of a leg: from the image of its begin to the image of its end.
  EdgeSegment seen_from(std::size_t leg) const {
    return {fold_point(segment_.from, leg), fold_direction(segment_.d, leg), segment_.length};
  }

  /// Returns a point of unfolded space in the space of a leg.
  Double3 fold_point(Double3 p, std::size_t leg) const {
    for (std::size_t k = 0; k < leg; ++k) p = mirrors_[k].image(p);
    return p;
  }
  Double3 fold_direction(Double3 d, std::size_t leg) const {
    for (std::size_t k = 0; k < leg; ++k) d = mirrors_[k].reflected(d);
    return d;
  }
  /// Returns a point of the space of a leg in unfolded space.
  Double3 unfold_point(Double3 p, std::size_t leg) const {
    for (std::size_t k = leg; k-- > 0;) p = mirrors_[k].image(p);
    return p;
  }
  Double3 unfold_direction(Double3 d, std::size_t leg) const {
    for (std::size_t k = leg; k-- > 0;) d = mirrors_[k].reflected(d);
    return d;
  }

  /// Sets the part of an edge, found beside `seen_from(leg)`, that lies before the mirrors at the ends of the leg, in
  /// unfolded space: `edge` and the positions on it in `unfolded`. Returns false if there is none. An edge in the
  /// plane of a mirror is none: what bounds the mirror or stands on it has no end there in unfolded space.
  bool unfold(const EdgePassage& passage, std::size_t leg, MeshEdge& edge, EdgePassage& unfolded) const;

  /// Divides the line from `a` on a leg to `b` on that leg or a later one, points of unfolded space, into its pieces
  /// between mirrors. `b` is a direction if `is_infinite`. Calls is_free(from, to, is_infinite) for each piece and
  /// is_mirror(from, to, normal) for the short line across each mirror, in the space of the leg before it. Returns
  /// false where one of them does, or if the line does not pass the mirrors in their order.
  template <class IsFree, class IsMirror>
  bool visit_pieces(const Double3& a, std::size_t leg_a, const Double3& b, std::size_t leg_b,
                    bool is_infinite, const IsFree& is_free, const IsMirror& is_mirror) const {
    const Double3 d = is_infinite ? b : b - a;
    double begin = 0;
    for (std::size_t leg = leg_a; leg < leg_b; ++leg) {
      const Plane& plane = unfolded_[leg];
      const double height = dot(plane.p - a, plane.n), speed = dot(d, plane.n);
      if (!(height > 0) || !(speed > 0)) return false;
      const double at = height / speed;
      if (!(at > begin) || (!is_infinite && !(at < 1))) return false;
      // Visibility tests end shortly before a mirror, and begin shortly behind it.
      constexpr double kPart = 1e-5;
      const double margin = std::max(is_infinite ? 0 : kPart, rounding_ / speed);
      const double before = std::max(0.5 * (begin + at), at - margin);
      const double behind = is_infinite ? at + margin : std::min(0.5 * (at + 1), at + margin);
      const auto folded = [&](double t) { return fold_point(a + d * t, leg); };
      if (!is_free(folded(begin), folded(before), false) ||
          !is_mirror(folded(before), folded(behind), mirrors_[leg].n))
        return false;
      begin = behind;
    }
    const Double3 from = fold_point(a + d * begin, leg_b);
    return is_infinite ? is_free(from, fold_direction(d, leg_b), true)
                       : is_free(from, fold_point(b, leg_b), false);
  }

private:
  struct Plane {
    Double3 p, n;  ///< a point and the unit normal

    double height(const Double3& x) const { return dot(x - p, n); }
    Double3 image(const Double3& x) const { return x - n * (2 * height(x)); }
    Double3 reflected(const Double3& v) const { return v - n * (2 * dot(v, n)); }
  };

  std::size_t count_;
  bool is_open_ = true;
  EdgeSegment segment_;
  std::array<Plane, SegmentChain::kMaxLegs> mirrors_;   ///< behind each leg, with normals towards the path
  std::array<Plane, SegmentChain::kMaxLegs> unfolded_;  ///< in unfolded space, with normals along the path
  double rounding_;  ///< distance from a mirror that exceeds the rounding of coordinates
};

}  // namespace aureole
