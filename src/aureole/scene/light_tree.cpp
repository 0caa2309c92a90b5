// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/light_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace aureole {

namespace {

float sine_of(float cosine) { return std::sqrt(std::max(0.f, 1 - cosine * cosine)); }

/// Returns cos(max(0, a - b)) from cosines and sines of angles in [0, pi].
float cos_difference(float cos_a, float sin_a, float cos_b, float sin_b) {
  return cos_a > cos_b ? 1.f : cos_a * cos_b + sin_a * sin_b;
}
float sin_difference(float cos_a, float sin_a, float cos_b, float sin_b) {
  return cos_a > cos_b ? 0.f : sin_a * cos_b - cos_a * sin_b;
}

/// Grows the cone of normals of `a` to the smallest cone that contains both cones.
void merge_cones(EmissionBounds& a, const EmissionBounds& b) {
  const float theta_a = std::acos(std::clamp(a.cos_normals, -1.f, 1.f));
  const float theta_b = std::acos(std::clamp(b.cos_normals, -1.f, 1.f));
  const float between = std::acos(std::clamp(dot(a.axis, b.axis), -1.f, 1.f));
  if (std::min(between + theta_b, kPi) <= theta_a) return;
  if (std::min(between + theta_a, kPi) <= theta_b) {
    a.axis = b.axis, a.cos_normals = b.cos_normals;
    return;
  }
  const float half = 0.5f * (theta_a + between + theta_b);
  const Vec3 pivot = cross(a.axis, b.axis);
  if (half >= kPi || length_squared(pivot) == 0) {
    a.cos_normals = -1;
    return;
  }
  // The axis of `a` is rotated towards the axis of `b` by half - theta_a.
  const Vec3 k = normalize(pivot);
  const float angle = half - theta_a;
  a.axis = normalize(a.axis * std::cos(angle) + cross(k, a.axis) * std::sin(angle));
  a.cos_normals = std::cos(half);
}

EmissionBounds merged(const EmissionBounds& a, const EmissionBounds& b) {
  if (a.power == 0) return b;
  if (b.power == 0) return a;
  EmissionBounds r = a;
  r.box.extend(b.box);
  merge_cones(r, b);
  r.cos_emission = std::min(a.cos_emission, b.cos_emission);
  r.power = a.power + b.power;
  r.focus = (a.power * a.focus + b.power * b.focus) / r.power;
  return r;
}

/// Returns the cost of a cluster by the surface area orientation heuristic (Conty Estevez & Kulla 2018).
float cost_measure(const EmissionBounds& b) {
  const float theta_o = std::acos(std::clamp(b.cos_normals, -1.f, 1.f));
  const float theta_e = std::acos(std::clamp(b.cos_emission, -1.f, 1.f));
  const float theta_w = std::min(theta_o + theta_e, kPi);
  const float sin_o = sine_of(b.cos_normals);
  const float solid =
      2 * kPi * (1 - b.cos_normals) +
      kPi / 2 * (2 * theta_w * sin_o - std::cos(theta_o - 2 * theta_w) - 2 * theta_o * sin_o + b.cos_normals);
  const Vec3 d = b.box.diagonal();
  // A small length is added, so that the measure is also positive for flat or point-like clusters.
  const float l = length(d) * 0.1f;
  return b.power * b.focus * solid * ((d.x + l) * (d.y + l) + (d.y + l) * (d.z + l) + (d.z + l) * (d.x + l));
}

}  // namespace

LightTree::LightTree(std::vector<EmissionBounds> leaves) : leaves_(std::move(leaves)) {
  if (leaves_.empty()) return;
  node_of_leaf_.assign(leaves_.size(), -1);
  std::vector<std::uint32_t> order(leaves_.size());
  std::iota(order.begin(), order.end(), 0u);
  nodes_.reserve(2 * leaves_.size());
  build(order, 0, order.size(), -1);
}

std::int32_t LightTree::build(std::vector<std::uint32_t>& order, std::size_t begin, std::size_t end,
                              std::int32_t parent) {
  const std::int32_t index = std::int32_t(nodes_.size());
  nodes_.emplace_back();
  EmissionBounds bounds;
  bounds.power = 0;
  Bounds3 centers;
  for (size_t i = begin; i < end; ++i) {
    bounds = merged(bounds, leaves_[order[i]]);
    centers.extend(leaves_[order[i]].box.center());
  }
  {
    Node& node = nodes_.back();
    node.bounds = bounds;
    node.sin_normals = sine_of(bounds.cos_normals);
    node.sin_emission = sine_of(bounds.cos_emission);
    node.center = bounds.box.center();
    node.radius_squared = 0.25f * length_squared(bounds.box.diagonal());
    node.parent = parent;
  }
  if (end - begin == 1) {
    nodes_.back().leaf = order[begin];
    node_of_leaf_[order[begin]] = index;
    return index;
  }
  constexpr int kBuckets = 12;
  float best_cost = kInfinity;
  int best_axis = -1, best_bucket = 0;
  const auto bucket_of = [&](std::uint32_t leaf, int axis) {
    const float extent = centers.upper[axis] - centers.lower[axis];
    const float x = (leaves_[leaf].box.center()[axis] - centers.lower[axis]) / extent;
    return std::min(kBuckets - 1, int(x * kBuckets));
  };
  for (int axis = 0; axis < 3; ++axis) {
    if (!(centers.upper[axis] > centers.lower[axis])) continue;
    std::array<EmissionBounds, kBuckets> buckets;
    for (auto& b : buckets) b.power = 0;
    for (size_t i = begin; i < end; ++i) {
      auto& b = buckets[size_t(bucket_of(order[i], axis))];
      b = merged(b, leaves_[order[i]]);
    }
    // Splits beside empty buckets are skipped, since they divide the lights as the split before them does.
    std::array<int, kBuckets> used;
    int used_count = 0;
    for (int k = 0; k < kBuckets; ++k)
      if (buckets[size_t(k)].power != 0) used[size_t(used_count++)] = k;
    for (int split = 1; split < used_count; ++split) {
      EmissionBounds below = buckets[size_t(used[0])], above = buckets[size_t(used[size_t(split)])];
      for (int k = 1; k < split; ++k) below = merged(below, buckets[size_t(used[size_t(k)])]);
      for (int k = split + 1; k < used_count; ++k) above = merged(above, buckets[size_t(used[size_t(k)])]);
      const float cost = cost_measure(below) + cost_measure(above);
      if (cost < best_cost) best_cost = cost, best_axis = axis, best_bucket = used[size_t(split - 1)] + 1;
    }
  }
  size_t middle = (begin + end) / 2;
  if (best_axis >= 0) {
    const auto it =
        std::stable_partition(order.begin() + std::ptrdiff_t(begin), order.begin() + std::ptrdiff_t(end),
                              [&](std::uint32_t leaf) { return bucket_of(leaf, best_axis) < best_bucket; });
    const size_t split = size_t(it - order.begin());
    if (split > begin && split < end) middle = split;
  }
  build(order, begin, middle, index);
  const std::int32_t right = build(order, middle, end, index);
  nodes_[size_t(index)].right = right;
  return index;
}

float LightTree::importance(const Node& node, const Vec3& p, const Vec3& n) {
  if (!(node.bounds.power * node.bounds.focus > 0)) return 0;
  const Vec3 to_p = p - node.center;
  const float distance_squared = length_squared(to_p);
  // The squared distance has a lower bound, since inside or near the box the distance to its centre is not a
  // useful estimate.
  const float d2 = std::max(distance_squared, node.radius_squared);
  // Cone with apex p around the box's bounding sphere.
  float cos_box = -1, sin_box = 0;
  if (distance_squared > node.radius_squared) {
    const float sin2 = node.radius_squared / distance_squared;
    cos_box = std::sqrt(1 - sin2), sin_box = std::sqrt(sin2);
  }
  const float inverse = distance_squared > 0 ? 1 / std::sqrt(distance_squared) : 0.f;
  const Vec3 w = to_p * inverse;
  const float cos_w = dot(node.bounds.axis, w), sin_w = sine_of(cos_w);
  float cos_x = cos_difference(cos_w, sin_w, node.bounds.cos_normals, node.sin_normals);
  const float sin_x = sin_difference(cos_w, sin_w, node.bounds.cos_normals, node.sin_normals);
  cos_x = cos_difference(cos_x, sin_x, cos_box, sin_box);
  if (cos_x <= node.bounds.cos_emission) return 0;
  float result = node.bounds.power * node.bounds.focus * cos_x / std::max(d2, 1e-30f);
  if (!(n == Vec3{})) {
    const float cos_i = std::abs(dot(w, n)), sin_i = sine_of(cos_i);
    result *= cos_difference(cos_i, sin_i, cos_box, sin_box);
  }
  return std::max(result, 0.f);
}

std::optional<LightTree::Choice> LightTree::choose(const Vec3& p, const Vec3& n, float u,
                                                   float probability) const {
  std::int32_t index = 0;
  while (nodes_[size_t(index)].right >= 0) {
    const std::int32_t left = index + 1, right = nodes_[size_t(index)].right;
    const float a = importance(nodes_[size_t(left)], p, n), b = importance(nodes_[size_t(right)], p, n);
    if (!(a + b > 0)) return {};
    const float share = a / (a + b);
    if (u < share) {
      u = std::min(u / share, 0x1.fffffep-1f);
      probability *= share;
      index = left;
    } else {
      u = std::min((u - share) / (1 - share), 0x1.fffffep-1f);
      probability *= 1 - share;
      index = right;
    }
  }
  return Choice{nodes_[size_t(index)].leaf, probability, u};
}

float LightTree::importance_along(const Node& node, const Ray& ray, float t_max) {
  if (!(node.bounds.power * node.bounds.focus > 0)) return 0;
  // Integral of 1/d^2 along the segment: the angle that it subtends at the centre, over the distance of the
  // centre from the line.
  const Vec3 to = node.center - ray.o;
  const float nearest = dot(to, ray.d);
  const float distance =
      std::sqrt(std::max({length_squared(to) - nearest * nearest, node.radius_squared, 1e-30f}));
  const float angle = std::atan((t_max - nearest) / distance) + std::atan(nearest / distance);
  return node.bounds.power * node.bounds.focus * std::max(angle, 1e-30f) / distance;
}

std::optional<std::size_t> LightTree::choose_along(const Ray& ray, float t_max, float u) const {
  if (!can_be_connected()) return {};
  std::int32_t index = 0;
  while (nodes_[size_t(index)].right >= 0) {
    const std::int32_t left = index + 1, right = nodes_[size_t(index)].right;
    const float a = importance_along(nodes_[size_t(left)], ray, t_max);
    const float b = importance_along(nodes_[size_t(right)], ray, t_max);
    const float share = a / (a + b);
    const bool goes_left = u < share;
    u = std::min(goes_left ? u / share : (u - share) / (1 - share), 0x1.fffffep-1f);
    index = goes_left ? left : right;
  }
  return nodes_[size_t(index)].leaf;
}

float LightTree::probability(const Vec3& p, const Vec3& n, std::size_t leaf, float probability) const {
  std::int32_t index = node_of_leaf_[leaf];
  while (nodes_[size_t(index)].parent >= 0) {
    const std::int32_t parent = nodes_[size_t(index)].parent;
    const float a = importance(nodes_[size_t(parent + 1)], p, n);
    const float b = importance(nodes_[size_t(nodes_[size_t(parent)].right)], p, n);
    if (!(a + b > 0)) return 0;
    const float share = a / (a + b);
    probability *= index == parent + 1 ? share : 1 - share;
    index = parent;
  }
  return probability;
}

}  // namespace aureole
