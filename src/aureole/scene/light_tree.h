// SPDX-License-Identifier: Apache-2.0
// `LightTree`: a bounding volume hierarchy over parts of lights. It is traversed at random, with
// probabilities in proportion to an estimate of the irradiance from each child (Conty Estevez & Kulla 2018,
// "Importance sampling of many lights with adaptive tree splitting"; importance as in Pharr, Jakob &
// Humphreys 2023, section 12.6.3).
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "aureole/emitter/emitter.h"

namespace aureole {

class LightTree {
public:
  LightTree() = default;
  /// Builds the tree. The `power` of each leaf is relative; only ratios between leaves matter.
  explicit LightTree(std::vector<EmissionBounds> leaves);

  struct Choice {
    std::size_t leaf;
    float probability;
    float u;  ///< remaining random number in [0, 1), reusable for sampling within the leaf
  };
  /// Chooses a leaf for the point p with normal n (zero if light may arrive from both sides). The returned
  /// probability is multiplied by the argument `probability`, the probability of using the tree. Returns
  /// nothing if no light can reach p. Requires that the tree is not empty.
  std::optional<Choice> choose(const Vec3& p, const Vec3& n, float u, float probability = 1) const;
  /// Returns the probability with which `choose` finds this leaf.
  float probability(const Vec3& p, const Vec3& n, std::size_t leaf, float probability = 1) const;
  /// Chooses a leaf for the segment of a ray up to the distance t_max, by estimated irradiance along the
  /// segment from distance and power alone. Returns nothing if light sampling cannot choose any leaf.
  std::optional<std::size_t> choose_along(const Ray& ray, float t_max, float u) const;

  /// Estimate of the irradiance along the segment by all leaves together, in a unit that trees of the same scene share.
  float estimate_along(const Ray& ray, float t_max) const {
    return can_be_connected() ? importance_along(nodes_[0], ray, t_max) : 0;
  }

  bool empty() const { return leaves_.empty(); }
  std::size_t leaf_count() const { return leaves_.size(); }
  const EmissionBounds& leaf(std::size_t i) const { return leaves_[i]; }
  /// Whether light sampling can choose any of the leaves (`EmissionBounds::focus` > 0).
  bool can_be_connected() const { return !nodes_.empty() && nodes_[0].bounds.focus > 0; }
  /// Estimate of the irradiance by all leaves together at the point p with normal n (zero if light may arrive from both
  /// sides), in a unit that trees of the same scene share. Zero only where no light can reach p.
  float estimate(const Vec3& p, const Vec3& n) const {
    return nodes_.empty() ? 0 : importance(nodes_[0], p, n);
  }

private:
  struct Node {
    EmissionBounds bounds;
    float sin_normals = 0, sin_emission = 1;
    Vec3 center;
    float radius_squared = 0;
    std::int32_t right = -1;  ///< index of the second child (the first follows); -1 in a leaf
    std::int32_t parent = -1;
    std::uint32_t leaf = 0;
  };

  std::int32_t build(std::vector<std::uint32_t>& order, std::size_t begin, std::size_t end,
                     std::int32_t parent);
  static float importance(const Node& node, const Vec3& p, const Vec3& n);
  static float importance_along(const Node& node, const Ray& ray, float t_max);

  std::vector<EmissionBounds> leaves_;
  std::vector<Node> nodes_;
  std::vector<std::int32_t> node_of_leaf_;
};

}  // namespace aureole
