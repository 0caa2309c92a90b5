// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/light_sampler.h"

#include <algorithm>

namespace aureole {

LightSampler::LightSampler(const std::vector<Light>& lights, const std::vector<double>& powers,
                           const std::vector<double>& emitted)
    : first_leaf_(lights.size(), kNone), first_source_(lights.size(), kNone) {
  for (size_t i = 0; i < lights.size(); ++i) {
    if (!(emitted[i] > 0)) continue;
    first_source_[i] = sources_.size();
    for (size_t part = 0; part < lights[i].part_count(); ++part) {
      sources_.push_back({&lights[i], part});
      power_sums_.push_back((power_sums_.empty() ? 0 : power_sums_.back()) +
                            emitted[i] * double(lights[i].emission_bounds(part).power));
    }
  }
  std::vector<EmissionBounds> bounds;
  for (size_t i = 0; i < lights.size(); ++i) {
    if (!(powers[i] > 0)) continue;
    if (lights[i].is_infinite()) {
      infinite_.push_back(&lights[i]);
      continue;
    }
    first_leaf_[i] = parts_.size();
    for (size_t part = 0; part < lights[i].part_count(); ++part) {
      EmissionBounds b = lights[i].emission_bounds(part);
      b.power *= float(powers[i]);
      parts_.emplace_back(&lights[i], part);
      bounds.push_back(b);
    }
  }
  tree_ = LightTree(std::move(bounds));
  // If `focus` is zero everywhere, the tree's lights are for light tracing only, and light sampling never
  // chooses them.
  tree_probability_ = tree_.can_be_connected() ? 1.f : 0.f;
  // Each light at infinity has as much weight as the whole tree.
  double weights = tree_probability_;
  for (const Light* l : infinite_) weights += l->sampling_weight();
  for (const Light* l : infinite_) infinite_probability_.push_back(float(l->sampling_weight() / weights));
  if (!infinite_.empty()) tree_probability_ = float(tree_probability_ / weights);
  if (tree_probability_ > 0 && infinite_.empty() && parts_.size() == 1)
    single_ = LightChoice{parts_[0].first, parts_[0].second, 1};
  else if (!(tree_probability_ > 0) && infinite_.size() == 1)
    single_ = LightChoice{infinite_[0], 0, 1};
}

std::optional<LightChoice> LightSampler::choose_among(const Vec3& p, const Vec3& n, float u) const {
  if (empty()) return {};
  for (size_t i = 0; i < infinite_.size(); ++i) {
    // The probabilities may sum to less than 1 by rounding: the last light takes the remainder.
    const bool last = i + 1 == infinite_.size() && !(tree_probability_ > 0);
    if (u < infinite_probability_[i] || last) return LightChoice{infinite_[i], 0, infinite_probability_[i]};
    u -= infinite_probability_[i];
  }
  if (!(tree_probability_ > 0)) return {};
  const auto leaf = tree_.choose(p, n, std::min(u / tree_probability_, 0x1.fffffep-1f), tree_probability_);
  if (!leaf) return {};
  return LightChoice{parts_[leaf->leaf].first, parts_[leaf->leaf].second, leaf->probability};
}

std::optional<LightChoice> LightSampler::choose_by_power(Vec2 u) const {
  if (power_sums_.empty() || !(power_sums_.back() > 0)) return {};
  const double total = power_sums_.back();
  const double at = std::min(double(u.x) + double(u.y) * 0x1p-24, 1 - 0x1p-53) * total;
  // Index of the first cumulative sum beyond `at`; parts without power are never chosen.
  const size_t i =
      std::min(size_t(std::upper_bound(power_sums_.begin(), power_sums_.end(), at) - power_sums_.begin()),
               power_sums_.size() - 1);
  return LightChoice{sources_[i].first, sources_[i].second, source_probability(i)};
}

float LightSampler::source_probability(std::size_t i) const {
  return float((power_sums_[i] - (i > 0 ? power_sums_[i - 1] : 0)) / power_sums_.back());
}

float LightSampler::probability_by_power(const Light& light, std::size_t part) const {
  const std::size_t first = first_source_[light.index];
  return first == kNone || !(power_sums_.back() > 0) ? 0 : source_probability(first + part);
}

float LightSampler::probability(const Vec3& p, const Vec3& n, const Light& light, std::size_t part) const {
  if (light.is_infinite()) {
    const auto found = std::find(infinite_.begin(), infinite_.end(), &light);
    return found == infinite_.end() ? 0 : infinite_probability_[size_t(found - infinite_.begin())];
  }
  const std::size_t first = first_leaf_[light.index];
  if (first == kNone) return 0;
  return tree_.probability(p, n, first + part, tree_probability_);
}

}  // namespace aureole
