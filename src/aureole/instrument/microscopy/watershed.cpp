// SPDX-License-Identifier: Apache-2.0
// Divides touching particles along the watersheds of the distance from their outline (Vincent & Soille,
// "Watersheds in digital spaces", 1991). Flooding starts at the deepest pixels; shallow basins are merged.
#include <algorithm>
#include <cstdint>

#include "aureole/instrument/microscopy/segmentation.h"

namespace aureole {
namespace {

// least height of a basin above its pass [pixels]: the steps of a digital outline
constexpr float kMinHeight = 0.75f;
// least height as a fraction of a basin's depth: two equal touching discs have a neck of at most half their
// radius
constexpr float kMinPart = 0.25f;

class Basins {
public:
  int add(float peak) {
    parent_.push_back(int(parent_.size())), peak_.push_back(peak);
    return parent_.back();
  }
  int root(int i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  /// Whether the pass at height `pass` separates the basins.
  bool are_two(int a, int b, float pass) const {
    const float lower = std::min(peak_[a], peak_[b]);
    return lower - pass > std::max(kMinHeight, kMinPart * lower);
  }
  void merge(int a, int b) {
    if (peak_[a] < peak_[b]) std::swap(a, b);
    parent_[b] = a;
  }
  int size() const { return int(parent_.size()); }

private:
  std::vector<int> parent_;
  std::vector<float> peak_;
};

/// Pixels of positive depth, deepest first; pixels of equal depth by index.
std::vector<std::uint32_t> by_depth(const std::vector<float>& depth) {
  constexpr float kSteps = 32;
  float most = 0;
  for (const float d : depth) most = std::max(most, d);
  std::vector<std::uint32_t> start(size_t(most * kSteps) + 2);
  const auto key = [&](float d) { return size_t((most - d) * kSteps); };
  for (const float d : depth)
    if (d > 0) ++start[key(d) + 1];
  for (size_t i = 1; i < start.size(); ++i) start[i] += start[i - 1];
  std::vector<std::uint32_t> order(start.back());
  for (size_t i = 0; i < depth.size(); ++i)
    if (depth[i] > 0) order[start[key(depth[i])]++] = std::uint32_t(i);
  return order;
}

}  // namespace

std::vector<int> divide(const std::vector<float>& depth, int width, int height, int& count) {
  std::vector<int> label(depth.size(), -1);
  Basins basins;
  for (const std::uint32_t i : by_depth(depth)) {
    const int x = int(i) % width, y = int(i) / width;
    int own = -1;
    float deepest = -1;
    int near[8], nears = 0;
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        if ((dx == 0 && dy == 0) || x + dx < 0 || y + dy < 0 || x + dx >= width || y + dy >= height) continue;
        const size_t j = size_t(y + dy) * width + size_t(x + dx);
        if (label[j] < 0) continue;
        const int root = basins.root(label[j]);
        if (std::find(near, near + nears, root) == near + nears) near[nears++] = root;
        if (depth[j] > deepest) deepest = depth[j], own = root;
      }
    if (own < 0) {
      label[i] = basins.add(depth[i]);
      continue;
    }
    label[i] = own;
    for (int a = 0; a < nears; ++a)
      for (int b = a + 1; b < nears; ++b) {
        const int p = basins.root(near[a]), q = basins.root(near[b]);
        if (p != q && !basins.are_two(p, q, depth[i])) basins.merge(p, q);
      }
  }
  std::vector<int> name(size_t(basins.size()), 0);
  count = 0;
  for (int& l : label) {
    if (l < 0) {
      l = 0;
      continue;
    }
    int& n = name[size_t(basins.root(l))];
    if (n == 0) n = ++count;
    l = n;
  }
  return label;
}

}  // namespace aureole
