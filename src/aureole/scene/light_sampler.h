// SPDX-License-Identifier: Apache-2.0
// `LightSampler`: chooses a light for next-event estimation. The choice is an emitter at infinity, by its
// sampling weight, or one part of another light, found in a tree over all parts (scene/light_tree.h).
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
  /// Makes a sampler. `powers` has one number >= 0 per light: its power weighted by the film's response,
  /// times its sampling weight. `emitted` has the corresponding numbers for `choose_by_power`. The lights
  /// must outlive the sampler and have their indices.
  LightSampler(const std::vector<Light>& lights, const std::vector<double>& powers,
               const std::vector<double>& emitted);

  /// Chooses a part of a light for the point p with normal n (zero if light may arrive from both sides).
  /// Returns nothing if no light can reach p.
  std::optional<LightChoice> choose(const Vec3& p, const Vec3& n, float u) const {
    return single_ ? single_ : choose_among(p, n, u);
  }
  /// Returns the probability with which `choose` finds this part.
  float probability(const Vec3& p, const Vec3& n, const Light& light, std::size_t part) const;

  /// Chooses a part in proportion to its power alone, for paths that start at lights. `u` is one random
  /// number in two floats, since a single float cannot resolve the parts of a large mesh.
  std::optional<LightChoice> choose_by_power(Vec2 u) const;
  /// Returns the sum of the powers among which `choose_by_power` chooses.
  double power() const { return power_sums_.empty() ? 0 : power_sums_.back(); }
  /// Returns the probability with which `choose_by_power` finds this part.
  float probability_by_power(const Light& light, std::size_t part) const;

  /// Whether there is only one candidate, so that `choose` ignores u.
  bool is_single() const { return single_.has_value(); }
  bool empty() const { return infinite_.empty() && tree_.empty(); }
  /// The tree over the parts of all lights that are not at infinity.
  const LightTree& tree() const { return tree_; }
  std::size_t leaf_count() const { return tree_.leaf_count(); }

private:
  static constexpr std::size_t kNone = ~std::size_t(0);
  float source_probability(std::size_t source) const;
  std::optional<LightChoice> choose_among(const Vec3& p, const Vec3& n, float u) const;
  std::vector<const Light*> infinite_;
  std::vector<float> infinite_probability_;  ///< probability of each light in `infinite_`
  float tree_probability_ = 0;
  std::optional<LightChoice> single_;  ///< the only candidate, if there is only one
  LightTree tree_;
  std::vector<std::pair<const Light*, std::size_t>> parts_;  ///< light and part at each leaf of the tree
  /// Index of each light's first leaf; kNone if the light is not in the tree.
  std::vector<std::size_t> first_leaf_;
  /// Index of each light's first source; kNone if the light is never chosen by power.
  std::vector<std::size_t> first_source_;
  /// Light and part of each candidate of `choose_by_power`.
  std::vector<std::pair<const Light*, std::size_t>> sources_;
  /// Cumulative power up to and including each source.
  std::vector<double> power_sums_;
};

}  // namespace aureole
