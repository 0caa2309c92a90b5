// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/edge/edge_tree.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <tuple>

namespace aureole {
namespace {

/// The direction from a point to an end of a path, and the squared distance (1 for an end at infinity).
struct Towards {
  Vec3 d;
  float distance_squared;

  Towards(const PathEnd& end, const Vec3& from) {
    if (end.is_infinite) {
      d = end.p, distance_squared = 1;
      return;
    }
    const Vec3 to = end.p - from;
    distance_squared = std::max(length_squared(to), 1e-30f);
    d = to * (1 / std::sqrt(distance_squared));
  }
};

// The functions below are heuristics: they change the noise of pictures, not their mean.

/// Returns the natural logarithm of x >= 1, within 0.06, by the exponent of the float.
float rough_log(float x) { return 0.69314718f * (float(std::bit_cast<std::int32_t>(x)) * 0x1p-23f - 127.f); }

/// Relative weight of an edge that is no outline between the two ends. It is not 0, since the ends only guide
/// the choice.
constexpr double kNoOutline = 1e-3;

/// Returns the relative power that an edge of length `length` diffracts at the difference of cosines `off`
/// from Keller's cone. `rate` is the change of the directions per distance along the edge. `turn` is the
/// angle by which the light turns if the edge's direction is unknown, else 0. Corners diffract a little in
/// all directions. Edges shorter than four sigma interfere with others: each of them counts wherever any edge
/// within seven sigma diffracts.
float along_cone(float off, float turn, float angle, float sigma, float length, float rate) {
  const float width = angle * std::max(1.f, 4 * sigma / length);
  const float k = 1 / (1 + (off / width) * (off / width));
  const float near = k * k * k * width / (width + turn);
  if (length > 4 * sigma) return near + 1e-3f * k;
  const float beside = off / (7 * sigma * rate + width);
  return std::max(near, 0.3f / (1 + beside * beside));
}

NormalCone of_line(const Vec3& d) { return {d, 1e-6f}; }

NormalCone merged_lines(const NormalCone& a, const NormalCone& b) {
  return a.merged(dot(a.axis, b.axis) < 0 ? NormalCone{-b.axis, b.sine} : b);
}

/// Returns an approximation of `keller_point` in single precision, relative to the middle of an edge; 0 if
/// there is none.
float about_keller(const Vec3& middle, const Vec3& e, const PathEnd& a, const PathEnd& b) {
  if (a.is_infinite) return b.is_infinite ? 0.f : about_keller(middle, e, b, a);
  const auto place = [&](const PathEnd& end, float& along, float& across) {
    const Vec3 to = end.p - middle;
    along = dot(to, e);
    across = length(to - e * along);
  };
  float along_a, across_a, along_b, across_b;
  place(a, along_a, across_a);
  if (b.is_infinite) {
    const float s = dot(b.p, e), c2 = 1 - s * s;
    return c2 > 1e-6f ? along_a + s * across_a / std::sqrt(c2) : 0.f;
  }
  place(b, along_b, across_b);
  const float sum = across_a + across_b;
  return sum > 0 ? (along_a * across_b + along_b * across_a) / sum : 0.f;
}

/// Returns the importance of an edge with direction e between the ends a and b.
double between(const MeshEdge& edge, const Vec3& middle, const Vec3& e, float edge_length, const PathEnd& a,
               const PathEnd& b, float angle, float sigma) {
  const float half = 0.5f * edge_length;
  const Vec3 x = middle + e * std::clamp(about_keller(middle, e, a, b), -half, half);
  const Towards to_a(a, x), to_b(b, x);
  const Vec3 turn = to_a.d + to_b.d;
  const float off = std::abs(dot(turn, e));
  // The length of the part of the edge that contributes.
  const float across2 = std::max(1 - dot(to_a.d, e) * dot(to_a.d, e), 1e-6f);
  const float rate = (a.is_infinite ? 0.f : 1 / std::sqrt(to_a.distance_squared)) +
                     (b.is_infinite ? 0.f : 1 / std::sqrt(to_b.distance_squared));
  const float stretch = angle / (std::sqrt(across2) * rate + 1e-30f);
  const double outline = edge.is_outline(to_a.d - to_b.d) ? 1.0 : kNoOutline;
  return outline * std::min(edge_length, 4 * stretch) * along_cone(off, 0, angle, sigma, edge_length, rate) /
         (double(to_a.distance_squared) * to_b.distance_squared * (length_squared(turn) + angle * angle));
}

}  // namespace

std::optional<double> keller_point(const EdgeLine& line, const PathEnd& a, const PathEnd& b) {
  const auto place = [&](const PathEnd& end, double& along, double& across) {
    const Double3 to = Double3(end.p) - line.origin;
    along = dot(to, line.direction);
    across = length(to - line.direction * along);
  };
  double along_a, across_a, along_b, across_b;
  if (a.is_infinite && b.is_infinite) return {};
  if (a.is_infinite) return keller_point(line, b, a);
  place(a, along_a, across_a);
  if (b.is_infinite) {
    const double s = dot(Double3(b.p), line.direction), c2 = 1 - s * s;
    if (!(c2 > 1e-12)) return {};
    return along_a + s * across_a / std::sqrt(c2);
  }
  place(b, along_b, across_b);
  // The point on the shortest path: the half-planes of the two ends are unfolded about the line.
  const double sum = across_a + across_b;
  if (!(sum > 0)) return {};
  return (along_a * across_b + along_b * across_a) / sum;
}

struct EdgeTree::Item {
  Vec3 a, b;  ///< ends of the edge, or corners of the cluster's box
  float length, shortest;
  std::uint32_t count, index;
  bool is_cluster;

  float center(int axis) const { return 0.5f * (a[axis] + b[axis]); }
  void extend(Bounds3& box) const { box.extend(a), box.extend(b); }
};

EdgeTree::EdgeTree(std::span<const MeshEdge> edges, const EdgeClusters& clusters,
                   std::span<const optics::EdgeGroup> groups)
    : edges_(edges), clusters_(&clusters), groups_(groups) {
  if (edges.empty()) return;
  std::vector<Item> items;
  items.reserve(edges.size());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (clusters.number_of(i) != clusters.size()) continue;
    const float size = length(edges[i].b - edges[i].a);
    items.push_back({edges[i].a, edges[i].b, size, size, 1, std::uint32_t(i), false});
  }
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    Bounds3 box;
    Item item{{}, {}, 0, INFINITY, std::uint32_t(clusters.edges(c).size()), std::uint32_t(c), true};
    for (const std::uint32_t i : clusters.edges(c)) {
      box.extend(edges[i].a), box.extend(edges[i].b);
      const float size = length(edges[i].b - edges[i].a);
      item.length += size, item.shortest = std::min(item.shortest, size);
    }
    item.a = box.lower, item.b = box.upper;
    items.push_back(item);
  }
  nodes_.reserve(2 * items.size());
  nodes_.emplace_back();
  build(0, items, 0);
}

void EdgeTree::set_directions(Node& leaf) const {
  const auto of_edge = [&](std::uint32_t i) {
    const MeshEdge& edge = edges_[i];
    return std::pair(edge.is_boundary ? NormalCone{} : NormalCone::of(edge.n0, edge.n1),
                     of_line(normalize(edge.b - edge.a)));
  };
  if (!leaf.is_cluster) {
    std::tie(leaf.normals, leaf.lines) = of_edge(leaf.index);
    return;
  }
  const auto numbers = clusters_->edges(leaf.index);
  std::tie(leaf.normals, leaf.lines) = of_edge(numbers[0]);
  for (const std::uint32_t i : numbers.subspan(1)) {
    const auto [normals, lines] = of_edge(i);
    leaf.normals = leaf.normals.merged(normals), leaf.lines = merged_lines(leaf.lines, lines);
  }
}

namespace {

/// Returns the squared half diagonal of a box.
float size_of(const Bounds3& box) { return box.empty() ? 0.f : 0.25f * length_squared(box.diagonal()); }

struct Plane {
  int axis = -1;
  float at = 0;
};

constexpr int kBins = 16;

/// Computes `best_plane` across one axis for few items: they are sorted by their bins, most of which are
/// empty.
template <class Item>
void try_few(std::span<const Item> items, int axis, float begin, float extent, Plane& best, float& least) {
  struct {
    int bin;
    const Item* item;
  } sorted[kBins];
  const int count = int(items.size());
  for (int i = 0; i < count; ++i) {
    const Item& item = items[std::size_t(i)];
    const int bin = std::clamp(int((item.center(axis) - begin) / extent * kBins), 0, kBins - 1);
    int at = i;
    for (; at > 0 && sorted[at - 1].bin > bin; --at) sorted[at] = sorted[at - 1];
    sorted[at] = {bin, &item};
  }
  float right[kBins];
  Bounds3 box;
  for (int i = count - 1; i > 0; --i) sorted[i].item->extend(box), right[i] = size_of(box) * float(count - i);
  box = {};
  for (int i = 1; i < count; ++i) {
    sorted[i - 1].item->extend(box);
    if (sorted[i].bin == sorted[i - 1].bin) continue;
    const float cost = size_of(box) * float(i) + right[i];
    if (cost < least) least = cost, best = {axis, begin + extent * float(sorted[i - 1].bin + 1) / kBins};
  }
}

/// Returns the plane, of fifteen across each axis, with the smallest sum of number of edges times size of
/// their box: it separates small figures from the long edges around them.
template <class Item>
Plane best_plane(std::span<const Item> items, const Bounds3& centers) {
  Plane best;
  float least = INFINITY;
  if (items.size() <= kBins) {
    for (int axis = 0; axis < 3; ++axis)
      if (const float extent = centers.upper[axis] - centers.lower[axis]; extent > 0)
        try_few(items, axis, centers.lower[axis], extent, best, least);
    return best;
  }
  struct {
    Bounds3 box;
    float count = 0;
  } bins[3][kBins];
  const Vec3 extent = centers.diagonal();
  for (const Item& item : items)
    for (int axis = 0; axis < 3; ++axis) {
      if (!(extent[axis] > 0)) continue;
      const float at = (item.center(axis) - centers.lower[axis]) / extent[axis];
      auto& bin = bins[axis][std::clamp(int(at * kBins), 0, kBins - 1)];
      item.extend(bin.box);
      ++bin.count;
    }
  for (int axis = 0; axis < 3; ++axis) {
    if (!(extent[axis] > 0)) continue;
    float right[kBins] = {};
    Bounds3 box;
    float count = 0;
    for (int i = kBins - 1; i > 0; --i) {
      if (bins[axis][i].count > 0) box.extend(bins[axis][i].box), count += bins[axis][i].count;
      right[i] = size_of(box) * count;
    }
    box = {}, count = 0;
    for (int i = 1; i < kBins; ++i) {
      if (bins[axis][i - 1].count > 0) box.extend(bins[axis][i - 1].box), count += bins[axis][i - 1].count;
      const float cost = size_of(box) * count + right[i];
      if (count > 0 && count < float(items.size()) && cost < least)
        least = cost, best = {axis, centers.lower[axis] + extent[axis] * float(i) / kBins};
    }
  }
  return best;
}

/// Orders the items by the side of a plane on which they lie, and returns how many lie before it.
template <class Item>
std::size_t divide(std::span<Item> items, const Bounds3& centers, int depth) {
  constexpr int kMostUneven = 64;
  // A few long edges around a small figure of many edges are separated from it first: in one node with a part
  // of the figure they would spoil its estimate. Only many such uneven planes would make the tree too deep.
  if (depth < kMostUneven) {
    if (const Plane plane = best_plane(std::span<const Item>(items), centers); plane.axis >= 0) {
      const auto middle = std::partition(items.begin(), items.end(),
                                         [&](const Item& i) { return i.center(plane.axis) < plane.at; });
      const auto half = std::size_t(middle - items.begin());
      if (half > 0 && half < items.size()) return half;
    }
  }
  const Vec3 extent = centers.diagonal();
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  const std::size_t half = items.size() / 2;
  std::nth_element(items.begin(), items.begin() + std::ptrdiff_t(half), items.end(),
                   [&](const Item& i, const Item& j) {
                     const float a = i.center(axis), b = j.center(axis);
                     return a != b ? a < b : i.index < j.index;
                   });
  return half;
}

}  // namespace

void EdgeTree::build(std::uint32_t node, std::span<Item> items, int depth) {
  Bounds3 box, centers;
  float length = 0, shortest = INFINITY, count = 0;
  for (const Item& item : items) {
    item.extend(box);
    centers.extend(0.5f * (item.a + item.b));
    length += item.length, shortest = std::min(shortest, item.shortest), count += float(item.count);
  }
  nodes_[node].center = box.center();
  nodes_[node].radius = 0.5f * aureole::length(box.diagonal());
  nodes_[node].length = length, nodes_[node].shortest = shortest, nodes_[node].count = count;
  if (items.size() == 1) {
    nodes_[node].index = items[0].index;
    nodes_[node].is_leaf = true, nodes_[node].is_cluster = items[0].is_cluster;
    set_directions(nodes_[node]);
    return;
  }
  const std::size_t half = divide(items, centers, depth);
  const auto first = std::uint32_t(nodes_.size());
  nodes_[node].index = first;
  nodes_[node].is_leaf = nodes_[node].is_cluster = false;
  nodes_.resize(nodes_.size() + 2);
  build(first, items.first(half), depth + 1);
  build(first + 1, items.subspan(half), depth + 1);
  nodes_[node].normals = nodes_[first].normals.merged(nodes_[first + 1].normals);
  nodes_[node].lines = merged_lines(nodes_[first].lines, nodes_[first + 1].lines);
}

template <class Importance>
std::optional<EdgeTree::Leaf> EdgeTree::descend(double u, const Importance& importance) const {
  if (nodes_.empty()) return {};
  constexpr float kLeastShare = 1e-3f;
  std::uint32_t node = 0;
  float probability = 1;
  double own = nodes_[0].is_leaf ? importance(nodes_[0]) : 1;
  while (!nodes_[node].is_leaf) {
    const std::uint32_t first = nodes_[node].index;
    const double left = importance(nodes_[first]), right = importance(nodes_[first + 1]);
    const double sum = left + right;
    if (!(sum > 0) || !std::isfinite(sum)) return {};
    // The estimate of a node may be off by many orders of magnitude if an end is near to it.
    auto share = float(left / sum);
    if (left > 0 && right > 0) share = std::clamp(share, kLeastShare, 1 - kLeastShare);
    if (u < share) {
      u = std::min(u / share, 1 - 0x1p-53), probability *= share, node = first, own = left;
    } else {
      u = std::min((u - share) / (1 - share), 1 - 0x1p-53), probability *= 1 - share, node = first + 1;
      own = right;
    }
  }
  if (!(own > 0) || !(probability > 0)) return {};
  return Leaf{node, probability, own / probability, u};
}

std::optional<EdgeTree::Leaf> EdgeTree::choose_between(const PathEnd& a, const PathEnd& b, float angle,
                                                       float sigma, double u, const float* lit) const {
  return descend(u, [&](const Node& node) {
    const double part = lit ? double(lit[&node - nodes_.data()]) : 1.0;
    if (node.is_leaf && !node.is_cluster)
      return part *
             between(edges_[node.index], node.center, node.lines.axis, node.length, a, b, angle, sigma);
    const Towards to_a(a, node.center), to_b(b, node.center);
    const float r2 = node.radius * node.radius;
    // Returns a bound of how much the direction from a point of the node to an end may differ from that from
    // the node's centre.
    const auto slack_of = [&](const PathEnd& end, const Towards& to) {
      if (end.is_infinite) return 0.f;
      const float sine2 = r2 / to.distance_squared;  // of the angle that the node's radius subtends
      if (!(sine2 < 1)) return 2.f;
      return 1.0001f * std::sqrt(2 * sine2 / (1 + std::sqrt(1 - sine2))) + 1e-6f;
    };
    const float slack = slack_of(a, to_a) + slack_of(b, to_b);
    const Vec3 turn = to_a.d + to_b.d, mean = to_a.d - to_b.d;
    const float turn2 = length_squared(turn), mean2 = length_squared(mean);
    double outline = 1;
    if (node.normals.sine < 1) {
      // Outline edges have faces on both sides of the light; here all faces are on one side. The weight is
      // not 0, since the ends may only be near to those of the final path.
      const float off = std::abs(dot(node.normals.axis, mean)) - slack, limit = std::sqrt(mean2) + slack;
      if (off > node.normals.sine * limit) outline = kNoOutline;
    }
    // The mean of the inverse square of the angle over the node's possible edges: an upper bound would be
    // equally large for all nodes near an end.
    const float turned = std::max(0.f, std::sqrt(turn2) - slack), angle2 = angle * angle,
                slack2 = slack * slack;
    const float turned2 = turned * turned + angle2 + slack2 / (1 + rough_log(1 + slack2 / angle2));
    float off = 0;
    if (node.lines.sine < 1) {
      const float along = std::abs(dot(turn, node.lines.axis)),
                  cosine = std::sqrt(1 - node.lines.sine * node.lines.sine);
      const float beside = std::sqrt(std::max(0.f, turn2 - along * along));
      off = std::max(0.f, along * cosine - beside * node.lines.sine - slack);
    }
    const double da = a.is_infinite ? 1.f : std::max(to_a.distance_squared, r2),
                 db = b.is_infinite ? 1.f : std::max(to_b.distance_squared, r2);
    const auto rate =
        float((a.is_infinite ? 0 : 1 / std::sqrt(da)) + (b.is_infinite ? 0 : 1 / std::sqrt(db)));
    return part * outline * std::min(node.length, 4 * node.count * angle / (rate + 1e-30f)) *
           along_cone(off, node.lines.sine < 1 ? 0.f : std::sqrt(turn2), angle, sigma, node.shortest, rate) /
           (da * db * turned2);
  });
}

EdgeTree::Choice EdgeTree::edge_between(const Leaf& leaf, const PathEnd& a, const PathEnd& b) const {
  const Node& node = nodes_[leaf.node];
  if (!node.is_cluster) return {node.index, leaf.probability};
  const Vec3 to_a = Towards(a, node.center).d, to_b = Towards(b, node.center).d;
  // The axis of the turn, perpendicular to the light's mean direction; any direction if the light does not
  // turn.
  const Vec3 mean = to_a - to_b, d = length_squared(mean) > 0 ? normalize(mean) : to_a,
             across = cross(d, to_a + to_b);
  const Vec3 y = length_squared(across) > 0 ? normalize(across) : Vec3{};
  const auto own = groups_[node.index].choose({d.x, d.y, d.z}, {y.x, y.y, y.z}, leaf.u);
  return {clusters_->edges(node.index)[own.index], leaf.probability * float(own.probability)};
}

double EdgeTree::estimate(const MeshEdge& edge, const PathEnd& a, const PathEnd& b, float angle,
                          float sigma) {
  const Vec3 way = edge.b - edge.a;
  const float size = length(way);
  return between(edge, 0.5f * (edge.a + edge.b), way * (1 / size), size, a, b, angle, sigma);
}

std::optional<EdgeTree::Choice> EdgeTree::choose_from(const PathEnd& a, double u, const MeshEdge* leaving,
                                                      const float* lit) const {
  const auto leaf = descend(u, [&](const Node& node) {
    if (node.is_leaf && !node.is_cluster && &edges_[node.index] == leaving) return 0.0;
    const double length = lit ? double(node.length) * lit[&node - nodes_.data()] : double(node.length);
    if (a.is_infinite) return length;
    return length /
           std::max(double(length_squared(a.p - node.center)), 0.25 * node.radius * node.radius + 1e-30);
  });
  if (!leaf) return {};
  const Node& node = nodes_[leaf->node];
  if (!node.is_cluster) return Choice{node.index, leaf->probability};
  std::size_t without = optics::EdgeGroup::kNone;
  if (leaving) {
    const auto number = std::size_t(leaving - edges_.data());
    if (clusters_->number_of(number) == node.index) without = clusters_->place_of(number);
  }
  const auto own = groups_[node.index].choose_by_length(leaf->u, without);
  if (!own) return {};
  return Choice{clusters_->edges(node.index)[own->index], leaf->probability * float(own->probability)};
}

std::vector<float> EdgeTree::of_nodes(std::span<const float> edge_values) const {
  std::vector<float> values(nodes_.size());
  // Children have larger numbers than their node.
  for (std::size_t i = nodes_.size(); i-- > 0;) {
    const Node& node = nodes_[i];
    if (node.is_cluster) {
      double sum = 0;
      for (const std::uint32_t edge : clusters_->edges(node.index))
        sum += double(edge_values[edge]) * length(edges_[edge].b - edges_[edge].a);
      values[i] = float(sum / std::max(node.length, 1e-30f));
      continue;
    }
    if (node.is_leaf) {
      values[i] = edge_values[node.index];
      continue;
    }
    const Node &left = nodes_[node.index], &right = nodes_[node.index + 1];
    values[i] = (values[node.index] * left.length + values[node.index + 1] * right.length) /
                std::max(left.length + right.length, 1e-30f);
  }
  return values;
}

float EdgeTree::seen_from(const Vec3& p) const {
  const auto of = [&](const Node& node) {
    return node.length /
           std::max(length_squared(p - node.center), 0.25f * node.radius * node.radius + 1e-30f);
  };
  if (nodes_.empty()) return 0;
  const Node& root = nodes_[0];
  return root.is_leaf ? of(root) : of(nodes_[root.index]) + of(nodes_[root.index + 1]);
}

}  // namespace aureole
