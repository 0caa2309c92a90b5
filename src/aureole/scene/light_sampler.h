// SPDX-License-Identifier: Apache-2.0
// Which light to connect to: one of the emitters at infinity, by their sampling weights, or one part of the
// others, found in a tree over all parts (scene/light_tree.h).
#pragma once

#include <optional>
#include <vector>

#include "aureole/emitter/light.h"
#include "aureole/scene/light_tree.h"

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
  /// The sum of what `choose_by_power` compares.
  double power() const { return power_sums_.empty() ? 0 : power_sums_.back(); }
  /// The probability of that choice.
  float probability_by_power(const Light& light, std::size_t part) const;

  /// Whether there is only one choice, so that `choose` ignores u.
  bool is_single() const { return single_.has_value(); }
  bool empty() const { return infinite_.empty() && tree_.empty(); }
  /// Where those of the lights are that are not at infinity.
  const LightTree& tree() const { return tree_; }
  std::size_t leaf_count() const { return tree_.leaf_count(); }

private:
  static constexpr std::size_t kNone = ~std::size_t(0);
  float source_probability(std::size_t source) const;
  std::optional<LightChoice> choose_among(const Vec3& p, const Vec3& n, float u) const;
  std::vector<const Light*> infinite_;
  std::vector<float> infinite_probability_;  ///< of each of them
  float tree_probability_ = 0;
  std::optional<LightChoice> single_;  ///< the only one there is
  LightTree tree_;
  std::vector<std::pair<const Light*, std::size_t>> parts_;  ///< at its leaves
  std::vector<std::size_t> first_leaf_;    ///< of each light; kNone where it is not in the tree
  std::vector<std::size_t> first_source_;  ///< of each light; kNone where it is never chosen by power
  std::vector<std::pair<const Light*, std::size_t>> sources_;  ///< all parts, for choose_by_power
  std::vector<double> power_sums_;                             ///< up to and including each
};

}  // namespace aureole
