// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/edge/edge_screens.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace aureole {

using optics::PlanePoint;

namespace {

double cross(const PlanePoint& a, const PlanePoint& b) { return a.x * b.y - a.y * b.x; }
PlanePoint minus(const PlanePoint& a, const PlanePoint& b) { return {a.x - b.x, a.y - b.y}; }

bool have_common_end(const MeshEdge& a, const MeshEdge& b) {
  return a.a == b.a || a.a == b.b || a.b == b.a || a.b == b.b;
}

/// Returns the obliquity factor of light that turns at a part of an edge and at a screen, over that of light
/// that turns at the part alone. `rest` is the segment between the part and an end of the whole segment; `p`
/// is the point of the screen relative to the begin of `rest`.
double obliquity_past(const EdgePassage& part, const EdgeSegment& rest, const Double3& p, bool towards_end) {
  const Double3 to_screen = normalize(p);
  const Double3 from_screen = rest.is_infinite() ? rest.d : normalize(rest.d * rest.length - p);
  const double at_screen = obliquity_of_turn(to_screen, from_screen);
  const double at_part =
      towards_end ? obliquity_of_turn(part.in, to_screen) : obliquity_of_turn(from_screen, part.out);
  return at_screen * at_part / std::max(1e-6, obliquity_of_turn(part.in, part.out));
}

}  // namespace

EdgeScreens::EdgeScreens(const OutlineEdges& edges, const EdgeSegment& segment,
                         std::span<const EdgeBeside> beside)
    : edges_(edges), segment_(segment), beside_(beside) {
  const bool is_one = std::all_of(beside.begin(), beside.end(), [&](const EdgeBeside& e) {
    return edges.are_of_one_sheet(*e.passage.edge, *beside.front().passage.edge);
  });
  if (is_one) return;
  make_basis(segment.d, x_, y_);
  buckets_.resize(kBuckets);
  for (std::size_t i = 0; i < beside.size(); ++i) {
    const EdgePassage& passage = beside[i].passage;
    const DetourLine line(*passage.edge, segment);
    ends_.push_back(
        {line.in_fresnel_plane(passage.begin, x_, y_), line.in_fresnel_plane(passage.end, x_, y_)});
    for_each_bucket(i, [&](std::size_t b) { buckets_[b].push_back(std::uint32_t(i)); });
  }
}

std::size_t EdgeScreens::bucket_of(const PlanePoint& p) const {
  const double turn = std::atan2(p.y, p.x) / (2 * std::numbers::pi) + 0.5;
  return turn > 0 ? std::min(std::size_t(turn * kBuckets), kBuckets - 1) : 0;
}

/// Calls visit(bucket) for the azimuths of an edge about the segment, which span less than half a turn.
template <class Visit>
void EdgeScreens::for_each_bucket(std::size_t edge, const Visit& visit) const {
  std::size_t from = bucket_of(ends_[edge][0]), to = bucket_of(ends_[edge][1]);
  if (cross(ends_[edge][0], ends_[edge][1]) < 0) std::swap(from, to);
  for (std::size_t b = from;; b = (b + 1) % kBuckets) {
    visit(b);
    if (b == to) break;
  }
}

bool EdgeScreens::may_hide(std::size_t a, std::size_t b) const {
  const MeshEdge &first = *beside_[a].passage.edge, &second = *beside_[b].passage.edge;
  return a != b && !edges_.are_of_one_sheet(first, second) && !have_common_end(first, second);
}

void EdgeScreens::find_cuts(std::size_t edge, std::vector<double>& cuts) const {
  cuts.clear();
  const auto& [p, q] = ends_[edge];
  const PlanePoint along = minus(q, p);
  const double length = std::hypot(along.x, along.y);
  const EdgePassage& passage = beside_[edge].passage;
  const DetourLine line(*passage.edge, segment_);
  for_each_bucket(edge, [&](std::size_t b) {
    for (const std::uint32_t other : buckets_[b]) {
      if (!beside_[other].is_outline || !may_hide(edge, other)) continue;
      const PlanePoint from = ends_[other][0], to = minus(ends_[other][1], from);
      const double sine = cross(along, to), size = length * std::hypot(to.x, to.y);
      // Nearly parallel edges have no sharp crossing.
      constexpr double kLeastSine = 0.6;
      static_assert(kLeastSine * kLeastSine + OutlineEdges::kSideBySide * OutlineEdges::kSideBySide > 0.999);
      if (!(std::abs(sine) > kLeastSine * size)) continue;
      const PlanePoint apart = minus(from, p);
      double s = cross(apart, to) / sine;
      const double u = cross(apart, along) / sine;
      if (!(s > 0 && s < 1 && u >= 0 && u <= 1)) continue;
      // An edge oblique to the segment is curved in the Fresnel plane: the crossing is found by Newton's
      // method, with bisection as a safeguard.
      double begin = passage.begin, end = passage.end;
      const double side = cross(minus(p, from), to);
      double t = begin + s * (end - begin);
      for (int step = 0; step < 8; ++step) {
        const double off = cross(minus(line.in_fresnel_plane(t, x_, y_), from), to);
        if (std::abs(off) < 1e-6 * size) break;
        ((off > 0) == (side > 0) ? begin : end) = t;
        const double next = t - off / (sine / (passage.end - passage.begin));
        t = next > begin && next < end ? next : 0.5 * (begin + end);
      }
      cuts.push_back(t);
    }
  });
  std::sort(cuts.begin(), cuts.end());
  // An edge that reaches into several ranges of azimuths may have found a cut more than once.
  const double least = 1e-9 * (passage.end - passage.begin);
  cuts.erase(std::unique(cuts.begin(), cuts.end(), [&](double a, double b) { return b - a < least; }),
             cuts.end());
}

double EdgeScreens::cosine(std::size_t a, std::size_t b) const {
  const auto across = [&](std::size_t i) {
    const Double3& normal = beside_[i].side.normal;
    return normalize(normal - segment_.d * dot(normal, segment_.d));
  };
  return dot(across(a), across(b));
}

bool EdgeScreens::is_copy(std::size_t edge, const EdgePassage& part, double wavelength) const {
  if (is_one_sheet()) return false;
  const DetourLine own(*part.edge, segment_);
  const double t = dot(part.p - own.to_a, own.e);
  const auto& alike = buckets_[bucket_of(own.in_fresnel_plane(t, x_, y_))];
  return std::any_of(alike.begin(), alike.end(), [&](std::uint32_t other) {
    if (!may_hide(edge, other) || !beside_[other].is_outline) return false;
    const DetourLine line(*beside_[other].passage.edge, segment_);
    constexpr double kEqual = 1e-6;
    const bool is_other_first =
        line.length > own.length * (1 + kEqual) || (line.length > own.length * (1 - kEqual) && other < edge);
    if (!is_other_first) return false;
    const double at = dot(part.p - line.to_a, line.e);
    if (!(at > 0 && at < line.length)) return false;
    const Double3 apart = line.at(at) - part.p;
    const double depth = dot(apart, segment_.d);
    const double off = std::max(beside_[edge].side.offset, beside_[other].side.offset);
    return std::abs(depth) <= wavelength / 20 && length(apart - segment_.d * depth) <= 2 * off &&
           cosine(edge, other) > OutlineEdges::kSideBySide;
  });
}

void EdgeScreens::visit_parallel(std::size_t edge, const EdgePassage& part, bool towards_end,
                                 double wavelength,
                                 const std::function<void(const Screen&, double)>& visit) const {
  const double depth = dot(part.p, segment_.d);
  EdgeSegment rest{segment_.from, part.in, length(part.p)};
  if (towards_end) {
    rest.from = segment_.from + part.p, rest.d = part.out;
    rest.length = segment_.is_infinite() ? segment_.length : length(segment_.d * segment_.length - part.p);
  }
  const DetourLine own(*part.edge, segment_);
  const double t = dot(part.p - own.to_a, own.e);
  const auto look_at = [&](std::uint32_t other) {
    if (!may_hide(edge, other)) return;
    const EdgeBeside& screen = beside_[other];
    const double between = (dot(screen.passage.p, segment_.d) - depth) * (towards_end ? 1 : -1);
    if (!(between > wavelength / 20) || !(std::abs(cosine(edge, other)) >= OutlineEdges::kSideBySide)) return;
    const DetourLine line(*screen.passage.edge, rest);
    const double middle = line.middle(), at = std::clamp(middle, 0.0, line.length);
    const Double3 p = line.at(at);
    // Light may pass between the ends of two edges of a round outline.
    constexpr double kBeyond = 0.3;
    const double beyond = std::abs(middle - at) * line.scale(p);
    if (!(beyond <= kBeyond * std::sqrt(wavelength))) return;
    const double height = dot(rest.d * dot(p, rest.d) - p, screen.side.normal);
    const double v = line.parameter(middle);
    visit({std::copysign(v, height), rest.from + p + screen.side.normal * screen.side.offset,
           height < 0 ? obliquity_past(part, rest, p, towards_end) : 1,
           std::abs(height) < 4 * std::max(screen.side.offset, beside_[edge].side.offset)},
          std::hypot(v, beyond));
  };
  // Both ranges of azimuths are searched, since the segment may pass between the two edges.
  const std::size_t bucket = bucket_of(own.in_fresnel_plane(t, x_, y_));
  for (const std::size_t b : {bucket, (bucket + kBuckets / 2) % kBuckets})
    std::for_each(buckets_[b].begin(), buckets_[b].end(), look_at);
}

}  // namespace aureole
