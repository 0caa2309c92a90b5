// SPDX-License-Identifier: Apache-2.0
// Small meshes for tests of edges.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "aureole/scene/edge/edge_index.h"

namespace aureole::test {

struct Triangles {
  std::vector<Vec3> positions;
  std::vector<TriangleIndices> triangles;
  void add(const Vec3& a, const Vec3& b, const Vec3& c) {
    const auto n = std::uint32_t(positions.size());
    positions.insert(positions.end(), {a, b, c});
    triangles.push_back({n, n + 1, n + 2});
  }
  /// A disc of n triangles about a point, with a rim of n edges.
  void add_disc(const Vec3& center, float radius, int n) {
    const auto rim = [&](int i) {
      const float phi = 2 * std::numbers::pi_v<float> * float(i % n) / float(n);
      return center + radius * Vec3{std::cos(phi), std::sin(phi), 0};
    };
    for (int i = 0; i < n; ++i) add(center, rim(i), rim(i + 1));
  }
  EdgeIndex index() const {
    const TriangleSet set{positions, triangles};
    return EdgeIndex({&set, 1}, EdgeIndex::Of::edges);
  }
};

}  // namespace aureole::test
