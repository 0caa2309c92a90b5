// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/edge/beam_tree.h"

#include <algorithm>
#include <cmath>

namespace aureole {

NormalCone NormalCone::of(const Vec3& a, const Vec3& b) {
  const Vec3 sum = a + b;
  const float size = length(sum);
  if (!(size > 1e-3f)) return {};
  const Vec3 axis = sum * (1 / size);
  // The constant 1e-6 bounds the rounding of the normals.
  return {axis, std::min(std::max(length(cross(axis, a)), length(cross(axis, b))) + 1e-6f, 2.f)};
}

NormalCone NormalCone::merged(const NormalCone& other) const {
  if (sine > 1 || other.sine > 1) return {};
  const float between = std::atan2(length(cross(axis, other.axis)), dot(axis, other.axis));
  const float own = std::asin(sine), second = std::asin(other.sine);
  const float widest = std::max({own, second, 0.5f * (own + second + between)});
  if (!(widest < 1.55f)) return {};
  if (widest == own && between + second <= own) return *this;
  if (widest == second && between + own <= second) return other;
  // The axis of the merged cone lies between both, at the angle `widest` from the far side of each cone.
  const float turn = widest - own;
  const Vec3 side = other.axis - axis * dot(axis, other.axis);
  const float side_length = length(side);
  const Vec3 middle =
      side_length > 1e-6f ? axis * std::cos(turn) + side * (std::sin(turn) / side_length) : axis;
  return {normalize(middle), std::min(std::sin(widest) + 1e-5f, 1.f)};
}

struct BeamTree::Item {
  Bounds3 box;
  std::uint32_t index;
};

BeamTree::BeamTree(std::span<const Bounds3> boxes, std::span<const NormalCone> cones) {
  if (boxes.empty()) return;
  std::vector<Item> items;
  items.reserve(boxes.size());
  for (const Bounds3& box : boxes) items.push_back({box, std::uint32_t(items.size())});
  nodes_.reserve(boxes.size());
  nodes_.emplace_back();
  build(0, items, 0, 1, cones);
  nodes_.shrink_to_fit();
  items_.reserve(items.size());
  for (const Item& item : items) items_.push_back(item.index);
}

void BeamTree::build(std::uint32_t node, std::span<Item> items, std::uint32_t begin, std::size_t depth,
                     std::span<const NormalCone> cones) {
  constexpr std::size_t kLeaf = 4;
  Bounds3 box, centres;
  for (const Item& item : items) {
    box.extend(item.box);
    centres.extend(item.box.center());
  }
  nodes_[node].box = box;
  const Vec3 extent = centres.diagonal();
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  if (items.size() <= kLeaf || (!(extent[axis] > 0) && items.size() <= 64) || depth + 1 >= kMostDepth) {
    nodes_[node].first = begin, nodes_[node].count = std::uint32_t(items.size());
    if (cones.empty()) return;
    NormalCone cone = cones[items[0].index];
    for (const Item& item : items.subspan(1)) cone = cone.merged(cones[item.index]);
    nodes_[node].cone = cone;
    return;
  }
  // The plane, of 15 candidates, with the smallest sum of surface areas times items (Wald 2007, "On fast
  // construction of SAH-based bounding volume hierarchies").
  constexpr int kBins = 16;
  struct Bin {
    Bounds3 box;
    std::uint32_t count = 0;
  } bins[kBins];
  const auto bin_of = [&](const Item& item) {
    const float at = (item.box.center()[axis] - centres.lower[axis]) / extent[axis];
    return std::clamp(int(at * kBins), 0, kBins - 1);
  };
  const auto area = [](const Bounds3& b) {
    const Vec3 d = b.diagonal();
    return b.empty() ? 0.f : d.x * d.y + d.y * d.z + d.z * d.x;
  };
  auto middle = items.begin();
  // Beyond this depth, or if no plane divides the items, they are halved by number, which bounds the depth.
  if (extent[axis] > 0 && depth < kMostDepth - 34) {
    for (const Item& item : items) {
      Bin& bin = bins[bin_of(item)];
      bin.box.extend(item.box);
      ++bin.count;
    }
    float right[kBins] = {};
    Bounds3 rest;
    std::uint32_t count = 0;
    for (int i = kBins - 1; i > 0; --i) {
      rest.extend(bins[i].box), count += bins[i].count;
      right[i] = area(rest) * float(count);
    }
    float best = INFINITY;
    int split = 0;
    rest = {}, count = 0;
    for (int i = 1; i < kBins; ++i) {
      rest.extend(bins[i - 1].box), count += bins[i - 1].count;
      const float cost = area(rest) * float(count) + right[i];
      if (count > 0 && count < items.size() && cost < best) best = cost, split = i;
    }
    if (split > 0)
      middle =
          std::partition(items.begin(), items.end(), [&](const Item& item) { return bin_of(item) < split; });
  }
  if (middle == items.begin() || middle == items.end()) {
    middle = items.begin() + std::ptrdiff_t(items.size() / 2);
    std::nth_element(items.begin(), middle, items.end(), [&](const Item& a, const Item& b) {
      return a.box.center()[axis] < b.box.center()[axis];
    });
  }
  const auto half = std::size_t(middle - items.begin());
  const auto first = std::uint32_t(nodes_.size());
  nodes_[node].first = first;
  nodes_.resize(nodes_.size() + 2);
  build(first, items.first(half), begin, depth + 1, cones);
  build(first + 1, items.subspan(half), begin + std::uint32_t(half), depth + 1, cones);
  nodes_[node].cone = nodes_[first].cone.merged(nodes_[first + 1].cone);
}

}  // namespace aureole
