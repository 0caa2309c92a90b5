// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/edge/edge_screens.h"

#include <algorithm>
#include <array>
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
  is_one_sheet_ = std::all_of(beside.begin(), beside.end(), [&](const EdgeBeside& e) {
    return edges.are_of_one_sheet(*e.passage.edge, *beside.front().passage.edge);
  });
  if (is_one_sheet_) return;
  make_basis(segment.d, x_, y_);
  lines_.reserve(beside.size());
  for (const EdgeBeside& e : beside) {
    const DetourLine line(*e.passage.edge, segment);
    const Double3& normal = e.side.normal;
    lines_.push_back({line, normalize(normal - segment.d * dot(normal, segment.d)),
                      dot(e.passage.p, segment.d), line.in_fresnel_plane(e.passage.begin, x_, y_),
                      line.in_fresnel_plane(e.passage.end, x_, y_)});
    order_.push_back(std::uint32_t(order_.size()));
    largest_offset_ = std::max(largest_offset_, e.side.offset);
  }
  nodes_.reserve(beside.size());
  nodes_.emplace_back();
  build(0, 0, std::uint32_t(order_.size()), 0);
}

void EdgeScreens::build(std::uint32_t index, std::uint32_t first, std::uint32_t count, std::size_t depth) {
  Double3 low{kInfinity, kInfinity, kInfinity}, high = -low;
  Node node{{}, 0, kInfinity, -kInfinity, {kInfinity, kInfinity}, {-kInfinity, -kInfinity}, first, count};
  const auto ends_of = [&](std::uint32_t k) {
    const DetourLine& line = lines_[order_[k]].line;
    return std::array{line.to_a, line.at(line.length)};
  };
  for (std::uint32_t k = first; k < first + count; ++k) {
    for (const Double3& p : ends_of(k)) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
      const double at = dot(p, segment_.d);
      node.nearest = std::min(node.nearest, at), node.farthest = std::max(node.farthest, at);
    }
    const Line& line = lines_[order_[k]];
    for (const PlanePoint& p : {line.begin, line.end}) {
      node.lower = {std::min(node.lower.x, p.x), std::min(node.lower.y, p.y)};
      node.upper = {std::max(node.upper.x, p.x), std::max(node.upper.y, p.y)};
    }
  }
  node.center = (low + high) * 0.5;
  for (std::uint32_t k = first; k < first + count; ++k)
    for (const Double3& p : ends_of(k)) node.radius = std::max(node.radius, length(p - node.center));
  constexpr std::uint32_t kLeaf = 4;
  if (count > kLeaf && depth + 2 < kDepth) {
    const Double3 size = high - low;
    const Double3 axis = size.x >= size.y && size.x >= size.z ? Double3{1, 0, 0}
                         : size.y >= size.z                   ? Double3{0, 1, 0}
                                                              : Double3{0, 0, 1};
    const auto middle = [&](std::uint32_t i) {
      const DetourLine& line = lines_[i].line;
      return dot(line.at(0.5 * line.length), axis);
    };
    const auto begin = order_.begin() + first;
    std::nth_element(begin, begin + count / 2, begin + count,
                     [&](std::uint32_t a, std::uint32_t b) { return middle(a) < middle(b); });
    node.first = std::uint32_t(nodes_.size()), node.count = 0;
    nodes_.resize(nodes_.size() + 2);
    build(node.first, first, count / 2, depth + 1);
    build(node.first + 1, first + count / 2, count - count / 2, depth + 1);
  }
  nodes_[index] = node;
}

template <class Enters, class Visit>
void EdgeScreens::visit(const Enters& enters, const Visit& visit) const {
  std::array<std::uint32_t, kDepth + 1> stack;
  std::size_t size = 0;
  stack[size++] = 0;
  while (size > 0) {
    const Node& node = nodes_[stack[--size]];
    if (!enters(node)) continue;
    for (std::uint32_t k = 0; k < node.count; ++k) visit(std::size_t(order_[node.first + k]));
    if (node.count == 0) stack[size++] = node.first, stack[size++] = node.first + 1;
  }
}

bool EdgeScreens::may_hide(std::size_t a, std::size_t b) const {
  const MeshEdge &first = *beside_[a].passage.edge, &second = *beside_[b].passage.edge;
  return a != b && !edges_.are_of_one_sheet(first, second) && !have_common_end(first, second);
}

void EdgeScreens::find_cuts(std::size_t edge, std::vector<double>& cuts) const {
  cuts.clear();
  const PlanePoint p = lines_[edge].begin, q = lines_[edge].end, along = minus(q, p);
  const PlanePoint lower{std::min(p.x, q.x), std::min(p.y, q.y)},
      upper{std::max(p.x, q.x), std::max(p.y, q.y)};
  const double length = std::hypot(along.x, along.y);
  const EdgePassage& passage = beside_[edge].passage;
  const DetourLine& line = lines_[edge].line;
  visit(
      [&](const Node& node) {
        return node.lower.x <= upper.x && node.upper.x >= lower.x && node.lower.y <= upper.y &&
               node.upper.y >= lower.y;
      },
      [&](std::size_t other) {
        if (!beside_[other].is_outline || !may_hide(edge, other)) return;
        const PlanePoint from = lines_[other].begin, to = minus(lines_[other].end, from);
        const double sine = cross(along, to), size = length * std::hypot(to.x, to.y);
        // Nearly parallel edges have no sharp crossing.
        constexpr double kLeastSine = 0.6;
        static_assert(kLeastSine * kLeastSine + OutlineEdges::kSideBySide * OutlineEdges::kSideBySide >
                      0.999);
        if (!(std::abs(sine) > kLeastSine * size)) return;
        const PlanePoint apart = minus(from, p);
        double s = cross(apart, to) / sine;
        const double u = cross(apart, along) / sine;
        if (!(s > 0 && s < 1 && u >= 0 && u <= 1)) return;
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
      });
  std::sort(cuts.begin(), cuts.end());
  // Two edges may cross this one at one point.
  const double least = 1e-9 * (passage.end - passage.begin);
  cuts.erase(std::unique(cuts.begin(), cuts.end(), [&](double a, double b) { return b - a < least; }),
             cuts.end());
}

bool EdgeScreens::is_copy(std::size_t edge, const EdgePassage& part, double wavelength) const {
  if (is_one_sheet()) return false;
  const DetourLine& own = lines_[edge].line;
  const double reach = std::hypot(wavelength / 20, 2 * largest_offset_);
  bool is_found = false;
  const auto is_first = [&](std::size_t other) {
    if (!beside_[other].is_outline || !may_hide(edge, other)) return false;
    const DetourLine& line = lines_[other].line;
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
  };
  visit([&](const Node& node) { return !is_found && length(node.center - part.p) <= node.radius + reach; },
        [&](std::size_t other) { is_found = is_found || is_first(other); });
  return is_found;
}

std::optional<EdgeScreens::Screen> EdgeScreens::find_screen(
    std::size_t edge, const EdgePassage& part, bool towards_end, bool is_seen, int side, double wavelength,
    const std::function<bool(const Screen&)>& is_open) const {
  const double depth = dot(part.p, segment_.d);
  EdgeSegment rest{segment_.from, part.in, length(part.p)};
  Double3 from{};  // begin of `rest`, relative to that of the segment
  if (towards_end) {
    rest.from = segment_.from + part.p, rest.d = part.out, from = part.p;
    rest.length = segment_.is_infinite() ? segment_.length : length(segment_.d * segment_.length - part.p);
  }
  const double least_depth = wavelength / 20, root = std::sqrt(wavelength);
  // A screen with a larger v changes the wave on its open side by less than 1/(pi v), and lets less than that
  // pass in its shadow. Few edges are cheap, so that light deep in their shadows is right as well.
  const double largest = (beside_.size() > 64 ? 6 : 400) * root;
  std::optional<Screen> found;
  double nearest = largest;
  const auto look_at = [&](std::size_t other) {
    const EdgeBeside& screen = beside_[other];
    const double between = (lines_[other].depth - depth) * (towards_end ? 1 : -1);
    const double parallel = cosine(edge, other);
    if (!(between > least_depth) ||
        !((side == 0 ? std::abs(parallel) : side * parallel) >= OutlineEdges::kSideBySide) ||
        !may_hide(edge, other))
      return;
    const DetourLine line(lines_[other].line, rest);
    const double middle = line.middle(), at = std::clamp(middle, 0.0, line.length);
    const Double3 p = line.at(at);
    const double along = dot(p, rest.d);
    if (!(along > 0) || !(along < rest.length)) return;
    // Light may pass between the ends of two edges of a round outline.
    constexpr double kBeyond = 0.3;
    const double beyond = std::abs(middle - at) * line.scale(p);
    if (!(beyond <= kBeyond * root)) return;
    const double v = line.parameter(middle), distance = std::hypot(v, beyond);
    if (!(distance < nearest)) return;
    const double height = dot(rest.d * along - p, screen.side.normal);
    const bool is_at_border = std::abs(height) < 4 * std::max(screen.side.offset, beside_[edge].side.offset);
    const bool is_touched = std::abs(height) <= std::max(screen.side.rounding, beside_[edge].side.rounding);
    const Screen candidate{std::copysign(v, height),
                           rest.from + p + screen.side.normal * screen.side.offset,
                           height < 0 ? obliquity_past(part, rest, p, towards_end) : 1,
                           is_at_border,
                           is_touched,
                           other};
    if (!is_at_border && (candidate.v < 0) == is_seen) return;
    if (!is_seen && !is_open(candidate)) return;
    found = candidate, nearest = distance;
  };
  // A lower bound of Fresnel's parameter of the edges of a node: their distance from the light times the
  // smallest scale of the Fresnel plane.
  const auto bound = [&](const Node& node) {
    if ((towards_end ? node.farthest - depth : depth - node.nearest) <= least_depth) return double(kInfinity);
    constexpr double kSafety = 0.9;
    const Double3 to = node.center - from;
    const double off = length(to - rest.d * dot(to, rest.d)) - node.radius;
    return off > 0 ? kSafety * off * std::sqrt(2 / (length(to) + node.radius)) : 0.0;
  };
  struct Entry {
    std::uint32_t node;
    double bound;
  };
  std::array<Entry, kDepth + 1> stack;
  std::size_t size = 0;
  stack[size++] = {0, bound(nodes_[0])};
  while (size > 0) {
    const Entry entry = stack[--size];
    if (!(entry.bound < nearest)) continue;
    const Node& node = nodes_[entry.node];
    for (std::uint32_t k = 0; k < node.count; ++k) look_at(std::size_t(order_[node.first + k]));
    if (node.count > 0) continue;
    const Entry first{node.first, bound(nodes_[node.first])};
    const Entry second{node.first + 1, bound(nodes_[node.first + 1])};
    const bool is_ordered = first.bound <= second.bound;
    stack[size++] = is_ordered ? second : first;
    stack[size++] = is_ordered ? first : second;
  }
  return found;
}

}  // namespace aureole
