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

double square(double x) { return x * x; }

using LaneVector = std::array<optics::Lanes, 3>;
optics::Lanes dot(const LaneVector& a, const LaneVector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
optics::Lanes dot(const LaneVector& a, const Double3& b) { return a[0] * b.x + a[1] * b.y + a[2] * b.z; }

/// Light may pass between the ends of two edges of a round outline. An edge is a screen for light that passes up to
/// this distance beyond its ends, in units of Fresnel's parameter.
constexpr double kBeyond = 0.3;

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
                      line.in_fresnel_plane(e.passage.end, x_, y_), edges.sheet_of(*e.passage.edge), 0});
    Line& added = lines_.back();
    const bool is_alone = added.sheet == OutlineEdges::kNoSheet;
    added.sheet = is_alone ? lines_.size() | kAlone : added.sheet << 8 | e.passage.edge->leg;
    added.sector = sector_of(added.across);
    order_.push_back(std::uint32_t(order_.size()));
    largest_offset_ = std::max(largest_offset_, e.side.offset);
  }
  nodes_.reserve(beside.size());
  nodes_.emplace_back();
  build(0, 0, std::uint32_t(order_.size()), 0);
}

std::uint32_t EdgeScreens::sector_of(const Double3& across) const {
  const double turns = std::atan2(dot(across, y_), dot(across, x_)) / (2 * std::numbers::pi);
  // A vector without a component across the segment has no azimuth.
  return turns >= -1 && turns <= 1 ? std::uint32_t((turns + 1) * kSectors) % kSectors : 0;
}

void EdgeScreens::Block::set(std::uint32_t lane, const Line& line) {
  const auto put = [lane](LaneVector& lanes, const Double3& v) {
    lanes[0][lane] = v.x, lanes[1][lane] = v.y, lanes[2][lane] = v.z;
  };
  put(begin, line.line.to_a), put(e, line.line.e), put(across, line.across);
  length[lane] = line.line.length, depth[lane] = line.depth;
  plane_begin[0][lane] = line.begin.x, plane_begin[1][lane] = line.begin.y;
  plane_along[0][lane] = line.end.x - line.begin.x, plane_along[1][lane] = line.end.y - line.begin.y;
  if (lane == 0) sheet = line.sheet;
  if (line.sheet != sheet) sheet = kMixed;
  sectors |= 1u << line.sector;
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
  constexpr std::uint32_t kLeaf = 64;
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
  } else {
    // Lines of one sheet, which are no screens of each other, and parallel lines are in one block.
    std::sort(order_.begin() + first, order_.begin() + first + count, [&](std::uint32_t a, std::uint32_t b) {
      const Line &x = lines_[a], &y = lines_[b];
      return x.sheet != y.sheet ? x.sheet < y.sheet : x.sector < y.sector;
    });
    node.first = std::uint32_t(blocks_.size()), node.count = (count + kLanes - 1) / kLanes;
    for (std::uint32_t k = 0; k < count; k += kLanes) {
      Block& block = blocks_.emplace_back();
      block.count = std::min(kLanes, count - k);
      for (std::uint32_t i = 0; i < kLanes; ++i) {
        block.lines[i] = order_[first + std::min(k + i, count - 1)];
        block.set(i, lines_[block.lines[i]]);
      }
    }
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
    for (std::uint32_t k = 0; k < node.count; ++k) visit(blocks_[node.first + k]);
    if (node.count == 0) stack[size++] = node.first, stack[size++] = node.first + 1;
  }
}

bool EdgeScreens::may_hide(std::size_t a, std::size_t b) const {
  return lines_[a].sheet != lines_[b].sheet &&
         !have_common_end(*beside_[a].passage.edge, *beside_[b].passage.edge);
}

void EdgeScreens::find_cuts(std::size_t edge, std::vector<double>& cuts) const {
  using optics::Lanes;
  cuts.clear();
  const Line& own = lines_[edge];
  const PlanePoint p = own.begin, q = own.end, along = minus(q, p);
  const PlanePoint lower{std::min(p.x, q.x), std::min(p.y, q.y)},
      upper{std::max(p.x, q.x), std::max(p.y, q.y)};
  const double length2 = along.x * along.x + along.y * along.y;
  const EdgePassage& passage = beside_[edge].passage;
  // Adds the crossing with a line of a block, where both are chords of their curves in the Fresnel plane: at s of
  // this edge.
  const auto add = [&](const Block& block, std::uint32_t lane, double s, double sine) {
    const std::size_t other = block.lines[lane];
    if (!beside_[other].is_outline || !may_hide(edge, other)) return;
    // An edge oblique to the segment is curved in the Fresnel plane: the crossing is found by Newton's
    // method, with bisection as a safeguard.
    const PlanePoint from = lines_[other].begin, to = minus(lines_[other].end, from);
    const double size = std::sqrt(length2 * (to.x * to.x + to.y * to.y));
    double begin = passage.begin, end = passage.end;
    const double side = cross(minus(p, from), to);
    double t = begin + s * (end - begin);
    for (int step = 0; step < 8; ++step) {
      const double off = cross(minus(own.line.in_fresnel_plane(t, x_, y_), from), to);
      if (std::abs(off) < 1e-6 * size) break;
      ((off > 0) == (side > 0) ? begin : end) = t;
      const double next = t - off / (sine / (passage.end - passage.begin));
      t = next > begin && next < end ? next : 0.5 * (begin + end);
    }
    cuts.push_back(t);
  };
  visit(
      [&](const Node& node) {
        return node.lower.x <= upper.x && node.upper.x >= lower.x && node.lower.y <= upper.y &&
               node.upper.y >= lower.y;
      },
      [&](const Block& block) {
        if (block.sheet == own.sheet) return;
        const Lanes &to_x = block.plane_along[0], &to_y = block.plane_along[1];
        const Lanes sine = along.x * to_y - along.y * to_x, size2 = length2 * (to_x * to_x + to_y * to_y);
        // Nearly parallel edges have no sharp crossing.
        constexpr double kLeastSine = 0.6;
        static_assert(kLeastSine * kLeastSine + OutlineEdges::kSideBySide * OutlineEdges::kSideBySide >
                      0.999);
        const Lanes apart_x = block.plane_begin[0] - p.x, apart_y = block.plane_begin[1] - p.y;
        const Lanes s = (apart_x * to_y - apart_y * to_x) / sine,
                    u = (apart_x * along.y - apart_y * along.x) / sine;
        const optics::LaneBits crosses =
            sine * sine > kLeastSine * kLeastSine * size2 && s > 0 && s < 1 && u >= 0 && u <= 1;
        if (!optics::lanes_of(crosses)) return;
        for (std::uint32_t i = 0; i < block.count; ++i)
          if (crosses[i]) add(block, i, s[i], sine[i]);
      });
  std::sort(cuts.begin(), cuts.end());
  // Two edges may cross this one at one point.
  const double least = 1e-9 * (passage.end - passage.begin);
  cuts.erase(std::unique(cuts.begin(), cuts.end(), [&](double a, double b) { return b - a < least; }),
             cuts.end());
}

bool EdgeScreens::is_copy(std::size_t edge, const EdgePassage& part, double wavelength) const {
  using optics::Lanes;
  if (is_one_sheet()) return false;
  const Line& own = lines_[edge];
  const double reach2 = square(wavelength / 20) + square(2 * largest_offset_), reach = std::sqrt(reach2);
  const auto is_first = [&](std::size_t other) {
    if (!beside_[other].is_outline || !may_hide(edge, other)) return false;
    const DetourLine& line = lines_[other].line;
    constexpr double kEqual = 1e-6;
    const bool is_other_first = line.length > own.line.length * (1 + kEqual) ||
                                (line.length > own.line.length * (1 - kEqual) && other < edge);
    if (!is_other_first) return false;
    const double at = dot(part.p - line.to_a, line.e);
    if (!(at > 0 && at < line.length)) return false;
    const Double3 apart = line.at(at) - part.p;
    const double depth = dot(apart, segment_.d);
    const double off = std::max(beside_[edge].side.offset, beside_[other].side.offset);
    return std::abs(depth) <= wavelength / 20 && length(apart - segment_.d * depth) <= 2 * off &&
           cosine(edge, other) > OutlineEdges::kSideBySide;
  };
  bool is_found = false;
  visit([&](const Node& node) { return !is_found && length(node.center - part.p) <= node.radius + reach; },
        [&](const Block& block) {
          if (is_found || block.sheet == own.sheet) return;
          LaneVector apart{part.p.x - block.begin[0], part.p.y - block.begin[1], part.p.z - block.begin[2]};
          const Lanes at = dot(apart, block.e);
          for (std::size_t i = 0; i < 3; ++i) apart[i] -= at * block.e[i];
          // The tolerance allows for rounding.
          const optics::LaneBits is_near = at > 0 && at < block.length && dot(apart, apart) <= 1.01 * reach2;
          if (!optics::lanes_of(is_near)) return;
          for (std::uint32_t i = 0; i < block.count; ++i)
            if (is_near[i]) is_found = is_found || is_first(block.lines[i]);
        });
  return is_found;
}

optics::Lanes EdgeScreens::distances(const Block& block, const Search& search, double most_beyond) {
  using optics::Lanes, optics::square_root;
  const auto length_of = [](const LaneVector& v) { return square_root(dot(v, v)); };
  const Lanes between = search.towards_end ? block.depth - search.depth : search.depth - block.depth;
  const Lanes cosine = dot(block.across, search.across);
  const Lanes parallel = search.side == 0 ? (cosine < 0 ? -cosine : cosine) : cosine * double(search.side);
  optics::LaneBits is_screen = between > search.least_depth && parallel >= OutlineEdges::kSideBySide;
  const Lanes none = Lanes{} + double(kInfinity);
  if (!optics::lanes_of(is_screen)) return none;
  // The functions of `DetourLine`, for the lines of the block.
  const EdgeSegment& light = search.light;
  const LaneVector a{block.begin[0] - search.from.x, block.begin[1] - search.from.y,
                     block.begin[2] - search.from.z};
  const LaneVector& e = block.e;
  const auto at = [&](const Lanes& t) {
    return LaneVector{a[0] + t * e[0], a[1] + t * e[1], a[2] + t * e[2]};
  };
  const Double3 end = light.d * (light.is_infinite() ? 0 : light.length);
  const auto to_end = [&](const LaneVector& p) {
    return LaneVector{p[0] - end.x, p[1] - end.y, p[2] - end.z};
  };
  const Lanes t_a = -dot(a, e), d_a = length_of(at(t_a));
  const Lanes along = dot(e, light.d);
  Lanes middle;
  if (light.is_infinite()) {
    const Lanes across2 = 1 - along * along;
    middle = t_a + d_a * along / square_root(across2 < 1e-30 ? Lanes{} + 1e-30 : across2);
  } else {
    const Lanes t_b = t_a + light.length * along, d_b = length_of(to_end(at(t_b)));
    const Lanes sum = d_a + d_b;
    middle = sum > 0 ? (t_a * d_b + t_b * d_a) / sum : t_a;
  }
  // Most lines do not reach that point. sqrt(2/r) is the smallest scale of the Fresnel plane.
  const Lanes far = length_of(a) + block.length, most_off = most_beyond * square_root(0.5 * far);
  is_screen = is_screen && middle >= -most_off && middle <= block.length + most_off;
  if (!optics::lanes_of(is_screen)) return none;
  const auto scale = [&](const LaneVector& p, const Lanes& z1) {
    const Lanes r_z = length_of(p) + z1;
    Lanes sum = 1 / (r_z < 1e-30 ? Lanes{} + 1e-30 : r_z);
    if (!light.is_infinite()) sum += 1 / (length_of(to_end(p)) + (light.length - z1));
    return 2 * square_root(sum);
  };
  const Lanes nearest = middle < 0 ? Lanes{} : middle > block.length ? block.length : middle;
  const LaneVector p = at(nearest);
  const Lanes z1 = dot(p, light.d);
  const Lanes off = middle - nearest, beyond = (off < 0 ? -off : off) * scale(p, z1);
  is_screen = is_screen && z1 > 0 && beyond <= most_beyond;
  if (!light.is_infinite()) is_screen = is_screen && z1 < light.length;
  if (!optics::lanes_of(is_screen)) return none;
  const LaneVector q = at(middle);
  const Lanes z = dot(q, light.d);
  const LaneVector across{q[0] - z * light.d.x, q[1] - z * light.d.y, q[2] - z * light.d.z};
  const Lanes v = scale(q, z) * length_of(across);
  return is_screen ? square_root(v * v + beyond * beyond) : none;
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
  // pass in its shadow.
  const double largest = edges_.largest_window() * root;
  std::optional<Screen> found;
  double nearest = largest;
  const auto look_at = [&](std::size_t other, double distance) {
    if (!may_hide(edge, other)) return;
    const EdgeBeside& screen = beside_[other];
    const DetourLine line(lines_[other].line, rest);
    const double middle = line.middle();
    const Double3 p = line.at(std::clamp(middle, 0.0, line.length));
    const double height = dot(rest.d * dot(p, rest.d) - p, screen.side.normal);
    const bool is_at_border = std::abs(height) < 4 * std::max(screen.side.offset, beside_[edge].side.offset);
    if (!is_at_border && (height < 0) == is_seen) return;
    const bool is_touched = std::abs(height) <= std::max(screen.side.rounding, beside_[edge].side.rounding);
    const Screen candidate{std::copysign(line.parameter(middle), height),
                           rest.from + p + screen.side.normal * screen.side.offset,
                           height < 0 ? obliquity_past(part, rest, p, towards_end) : 1,
                           is_at_border,
                           is_touched,
                           other};
    if (!is_seen && !is_open(candidate)) return;
    found = candidate, nearest = distance;
  };
  const Line& own = lines_[edge];
  const Search search{from, rest, own.across, depth, least_depth, towards_end, side};
  // Edges count as parallel within 37 degrees.
  constexpr int kReach = int(0.11 * kSectors) + 1;
  std::uint32_t sectors = 0;
  for (int k = -kReach; k <= kReach; ++k) {
    const std::uint32_t sector = (own.sector + kSectors + std::uint32_t(k)) % kSectors;
    if (side >= 0) sectors |= 1u << sector;
    if (side <= 0) sectors |= 1u << (sector + kSectors / 2) % kSectors;
  }
  const auto look_at_leaf = [&](const Node& node) {
    for (std::uint32_t k = 0; k < node.count; ++k) {
      const Block& block = blocks_[node.first + k];
      if (!(block.sectors & sectors) || block.sheet == own.sheet) continue;
      const optics::Lanes distance = distances(block, search, kBeyond * root);
      if (!optics::lanes_of(distance < nearest)) continue;
      for (std::uint32_t i = 0; i < block.count; ++i)
        if (distance[i] < nearest) look_at(block.lines[i], distance[i]);
    }
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
    if (node.count > 0) {
      look_at_leaf(node);
      continue;
    }
    const Entry first{node.first, bound(nodes_[node.first])};
    const Entry second{node.first + 1, bound(nodes_[node.first + 1])};
    const bool is_ordered = first.bound <= second.bound;
    stack[size++] = is_ordered ? second : first;
    stack[size++] = is_ordered ? first : second;
  }
  return found;
}

}  // namespace aureole
