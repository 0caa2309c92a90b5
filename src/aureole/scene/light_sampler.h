// SPDX-License-Identifier: Apache-2.0
// `LightSampler`: chooses a light for next-event estimation. The choice is an emitter at infinity, by its
// sampling weight, or one part of another light, found in a tree over all parts (scene/light_tree.h).
// Where lights are modulated, choices for a path of known time take the power of that time: the lights of one modulation
// are a group with a tree of its own, and groups are weighted by their momentary brightness.
#pragma once

#include <array>
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
  /// times its sampling weight, in the mean over the exposure. `emitted` has the corresponding numbers for
  /// `choose_by_power`. `modulations` has the mean modulation of each light over the exposure (1 for a steady
  /// light), or is empty where all paths have the same time. The lights must outlive the sampler and have their
  /// indices.
  LightSampler(const std::vector<Light>& lights, const std::vector<double>& powers,
               const std::vector<double>& emitted, const std::vector<double>& modulations = {});

  /// Chooses a part of a light for the point p with normal n (zero if light may arrive from both sides), by
  /// mean powers. Returns nothing if no light can reach p.
  std::optional<LightChoice> choose(const Vec3& p, const Vec3& n, float u) const {
    return single_ ? single_ : choose_among(p, n, u);
  }
  /// Chooses a part by the powers at the time [s] of a path.
  std::optional<LightChoice> choose(const Vec3& p, const Vec3& n, float u, float time) const {
    return groups_.empty() ? choose(p, n, u) : choose_at(p, n, u, time);
  }
  /// Returns the probability with which `choose` finds this part, by mean powers.
  float probability(const Vec3& p, const Vec3& n, const Light& light, std::size_t part) const;
  /// Returns the probability with which `choose` finds this part at the time [s] of a path.
  float probability(const Vec3& p, const Vec3& n, const Light& light, std::size_t part, float time) const {
    return groups_.empty() ? probability(p, n, light, part) : probability_at(p, n, light, part, time);
  }

  /// Chooses a part in proportion to its mean power alone, for paths that start at lights. `u` is one random
  /// number in two floats, since a single float cannot resolve the parts of a large mesh.
  std::optional<LightChoice> choose_by_power(Vec2 u) const;
  /// Chooses a part in proportion to its power at the time [s] of a path.
  std::optional<LightChoice> choose_by_power(Vec2 u, float time) const;
  /// Returns the sum of the powers among which `choose_by_power` chooses.
  double power() const { return power_sums_.empty() ? 0 : power_sums_.back(); }
  /// Returns the probability with which `choose_by_power` finds this part, by mean powers.
  float probability_by_power(const Light& light, std::size_t part) const;
  /// Returns the probability with which `choose_by_power` finds this part at the time [s] of a path.
  float probability_by_power(const Light& light, std::size_t part, float time) const;

  /// The bounds of a part, none of them at infinity, that is near the segment of a ray up to t_max and emits at the time [s]
  /// of a path: for positions along the segment. Null if there is none.
  const EmissionBounds* choose_along(const Ray& ray, float t_max, float u, float time) const;

  /// Whether there is only one candidate, so that `choose` ignores u.
  bool is_single() const { return single_.has_value(); }
  bool empty() const { return infinite_.empty() && tree_.empty(); }
  /// The tree over the parts of all lights that are not at infinity.
  const LightTree& tree() const { return tree_; }
  std::size_t leaf_count() const { return tree_.leaf_count(); }

private:
  static constexpr std::size_t kNone = ~std::size_t(0);
  /// Upper bound of the number of groups: steady lights, and the modulations with the most mean power. Lights of further
  /// modulations count as steady.
  static constexpr std::size_t kMaxGroups = 16;
  /// The lights of one modulation, or all steady ones.
  struct Group {
    const Modulation* modulation = nullptr;  ///< null: steady
    double mean = 1;                         ///< of the modulation over the exposure
    LightTree tree;
    std::vector<std::size_t> parts;    ///< index in `parts_` of each leaf of the tree
    std::vector<std::size_t> sources;  ///< indices in `sources_`
    std::vector<double> power_sums;    ///< cumulative power up to and including each of `sources`
    /// Power at a time [s] over mean power.
    float brightness(float time) const;
  };
  /// Weights of a choice for a point at a time: brightness of each group, weight of each tree, sum over trees and lights at
  /// infinity.
  struct TimeWeights {
    std::array<float, kMaxGroups> brightness, trees;
    float total;
  };

  void make_groups(const std::vector<Light>& lights, const std::vector<EmissionBounds>& bounds,
                   const std::vector<double>& emitted, const std::vector<double>& modulations);
  TimeWeights weights_at(const Vec3& p, const Vec3& n, float time) const;
  std::optional<LightChoice> choose_at(const Vec3& p, const Vec3& n, float u, float time) const;
  float probability_at(const Vec3& p, const Vec3& n, const Light& light, std::size_t part, float time) const;

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
  std::vector<Group> groups_;            ///< empty where the powers do not change with time
  std::vector<std::uint32_t> group_of_;  ///< of each light
  std::vector<std::size_t> group_leaf_;  ///< leaf in its group's tree of each of `parts_`
};

}  // namespace aureole
