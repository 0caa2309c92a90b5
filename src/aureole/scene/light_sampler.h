// SPDX-License-Identifier: Apache-2.0
// Which light to connect to: one of the emitters at infinity, by their sampling weights, or one part of the
// others, found in a bounding-volume tree over all parts that is descended at random by an estimate of the
// light that each side sends to the point (Conty Estevez & Kulla 2018, "Importance sampling of many lights
// with adaptive tree splitting"; importance as in Pharr, Jakob & Humphreys 2023, section 12.6.3).
#pragma once

#include <optional>
#include <vector>

#include "aureole/emitter/light.h"

namespace aureole {

struct LightChoice {
  const Light* light;
  std::size_t part;
  float probability;
};

class LightSampler {
public:
  LightSampler() = default;
  /// `powers`: one positive or zero number per light, its power as the film sees it times its sampling
  /// weight.
  /// `emitted`: the same for `choose_by_power`. The lights must outlive it, and have their indices.
  LightSampler(const std::vector<Light>& lights, const std::vector<double>& powers,
               const std::vector<double>& emitted);

  /// A part of a light for the point p with normal n (zero for a point that light may reach from both
  /// sides). Nothing where no light can reach p.
  std::optional<LightChoice> choose(const Vec3& p, const Vec3& n, float u) const {
    return single_ ? single_ : choose_among(p, n, u);
  }
  /// The probability of that choice.
  float probability(const Vec3& p, const Vec3& n, const Light& light, std::size_t part) const;

  /// A part by its share of the power alone, for paths that start at lights; `u` is one number in two parts,
  /// since a float cannot tell the parts of a large mesh apart.
  std::optional<LightChoice> choose_by_power(Vec2 u) const;
  /// The probability of that choice.
  float probability_by_power(const Light& light, std::size_t part) const;

  /// Whether there is only one choice, so that `choose` ignores u.
  bool is_single() const { return single_.has_value(); }
  bool empty() const { return infinite_.empty() && nodes_.empty(); }
  std::size_t leaf_count() const { return leaves_.size(); }

private:
  static constexpr std::size_t kNone = ~std::size_t(0);
  struct Node {
    EmissionBounds bounds;
    float sin_normals = 0, sin_emission = 1;
    Vec3 center;
    float radius_squared = 0;
    std::int32_t right = -1;  ///< index of the second child (the first follows); -1 in a leaf
    std::int32_t parent = -1;
    std::uint32_t leaf = 0;
  };
  struct Leaf {
    const Light* light;
    std::size_t part;
    EmissionBounds bounds;
  };

  float source_probability(std::size_t source) const;
  std::optional<LightChoice> choose_among(const Vec3& p, const Vec3& n, float u) const;
  std::int32_t build(std::vector<std::uint32_t>& order, std::size_t begin, std::size_t end,
                     std::int32_t parent);
  static float importance(const Node& node, const Vec3& p, const Vec3& n);

  std::vector<const Light*> infinite_;
  std::vector<float> infinite_probability_;  ///< of each of them
  float tree_probability_ = 0;
  std::optional<LightChoice> single_;  ///< the only one there is
  std::vector<Leaf> leaves_;
  std::vector<Node> nodes_;
  std::vector<std::int32_t> node_of_leaf_;
  std::vector<std::size_t> first_leaf_;    ///< of each light; kNone where it is not in the tree
  std::vector<std::size_t> first_source_;  ///< of each light; kNone where it is never chosen by power
  std::vector<std::pair<const Light*, std::size_t>> sources_;  ///< all parts, for choose_by_power
  std::vector<double> power_sums_;                             ///< up to and including each
};

}  // namespace aureole
