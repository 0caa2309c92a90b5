// SPDX-License-Identifier: Apache-2.0
#include "aureole/transport/edge_unfolding.h"

#include <cmath>
#include <utility>

namespace aureole {

namespace {

double largest_coordinate(const Double3& p) {
  return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
}

}  // namespace

UnfoldedPath::UnfoldedPath(std::span<const PathLeg> legs, bool begins_at_infinity) : count_(legs.size()) {
  const std::size_t last = count_ - 1;
  double reach = 0, coordinate = 0;
  for (const PathLeg& leg : legs) {
    is_open_ &= leg.is_open;
    if (leg.length < kInfinity) reach += double(leg.length);
    coordinate = std::max(coordinate, largest_coordinate(Double3(leg.origin)));
  }
  constexpr double kRounding = 2e-6;
  rounding_ = kRounding * std::max(coordinate, reach);
  // A ray leaves a mirror from a point that lies off it by the bound of its error.
  for (const PathLeg& leg : legs)
    if (leg.continues())
      rounding_ =
          std::max(rounding_, 2 * double(std::abs(dot(leg.origin - leg.mirror_p, leg.mirror_normal))));
  for (std::size_t k = 0; k < last; ++k) {
    // Mirror k lies at the begin of the leg k + 1 or, in a reversed path, of its counterpart.
    const PathLeg& behind = legs[begins_at_infinity ? last - k : k + 1];
    Plane& mirror = mirrors_[k];
    // The ray leaves the mirror from a point a little off it. A plane half way continues the line on which it arrives.
    mirror = {0.5 * (Double3(behind.mirror_p) + Double3(behind.origin)),
              normalize(Double3(behind.mirror_normal))};
    if (dot(Double3(behind.d), mirror.n) < 0) mirror.n = -mirror.n;
  }
  for (std::size_t k = 0; k < last; ++k)
    unfolded_[k] = {unfold_point(mirrors_[k].p, k), -unfold_direction(mirrors_[k].n, k)};
  const auto end_of = [](const PathLeg& leg) {
    return Double3(leg.origin) + normalize(Double3(leg.d)) * double(leg.length);
  };
  const bool is_infinite = begins_at_infinity || !(legs[last].length < kInfinity);
  segment_.from = begins_at_infinity ? end_of(legs[last]) : Double3(legs[0].origin);
  if (is_infinite) {
    const Double3 d = normalize(begins_at_infinity ? -Double3(legs[0].d) : Double3(legs[last].d));
    segment_.d = unfold_direction(d, last), segment_.length = double(kInfinity);
  } else {
    const Double3 along = unfold_point(end_of(legs[last]), last) - segment_.from;
    segment_.length = length(along);
    segment_.d = along * (1 / segment_.length);
  }
}

bool UnfoldedPath::unfold(const EdgePassage& passage, std::size_t leg, MeshEdge& edge,
                          EdgePassage& unfolded) const {
  edge = *passage.edge;
  edge.leg = std::uint8_t(leg);
  const Double3 a(edge.a), along = Double3(edge.b) - a;
  const double size = length(along);
  double begin = 0, end = size;
  const auto clip = [&](const Plane& plane) {
    const double at_begin = plane.height(a), at_end = plane.height(Double3(edge.b));
    const double rounding = std::max(rounding_, 2e-6 * std::max(largest_coordinate(a), size));
    if (std::max(at_begin, at_end) <= rounding) return false;
    const double crossing = at_begin / (at_begin - at_end) * size;
    if (at_begin < -rounding) begin = std::max(begin, crossing);
    if (at_end < -rounding) end = std::min(end, crossing);
    return begin < end;
  };
  if (leg + 1 < count_ && !clip(mirrors_[leg])) return false;
  if (leg > 0 && !clip(mirrors_[leg - 1])) return false;
  unfolded = passage;
  unfolded.begin = std::max(passage.begin, begin), unfolded.end = std::min(passage.end, end);
  if (!(unfolded.begin < unfolded.end)) return false;
  const auto place = [&](const Double3& p) { return unfold_point(p, leg).to_float(); };
  const bool is_cut = begin > 0 || end < size;
  const Vec3 first = place(begin > 0 ? a + along * (begin / size) : a),
             second = place(end < size ? a + along * (end / size) : Double3(edge.b));
  edge.n0 = unfold_direction(Double3(edge.n0), leg).to_float();
  edge.n1 = unfold_direction(Double3(edge.n1), leg).to_float();
  edge.a = first, edge.b = second;
  // An odd number of reflections exchanges left and right, and the order of the ends with it.
  const bool is_reversed = leg % 2 == 1;
  if (is_reversed) std::swap(edge.a, edge.b);
  const double new_size = is_cut ? length(Double3(edge.b) - Double3(edge.a)) : size;
  const auto position = [&](double t) { return is_reversed ? end - t : t - begin; };
  unfolded.middle = position(passage.middle);
  const double p = position(unfolded.begin), q = position(unfolded.end);
  unfolded.begin = std::clamp(std::min(p, q), 0.0, new_size);
  unfolded.end = std::clamp(std::max(p, q), 0.0, new_size);
  return unfolded.begin < unfolded.end;
}

}  // namespace aureole
