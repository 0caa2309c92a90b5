// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/light_sampler.h"

#include <algorithm>
#include <unordered_map>

#include "aureole/modulation/modulation.h"

namespace aureole {

LightSampler::LightSampler(const std::vector<Light>& lights, const std::vector<double>& powers,
                           const std::vector<double>& emitted, const std::vector<double>& modulations)
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
  if (!modulations.empty()) make_groups(lights, bounds, emitted, modulations);
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

float LightSampler::Group::brightness(float time) const {
  return modulation ? float(double(modulation->at(double(time))) / mean) : 1.f;
}

void LightSampler::make_groups(const std::vector<Light>& lights, const std::vector<EmissionBounds>& bounds,
                               const std::vector<double>& emitted, const std::vector<double>& modulations) {
  // Modulations in the order of their first lights, with their power and mean.
  struct Candidate {
    const Modulation* modulation;
    double mean, power;
    std::size_t order;
  };
  std::vector<Candidate> candidates;
  std::unordered_map<const Modulation*, std::size_t> known;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const Modulation* modulation = lights[i].emitter->modulation();
    if (!modulation) continue;
    const auto [at, is_new] = known.try_emplace(modulation, candidates.size());
    if (is_new) candidates.push_back({modulation, modulations[i], 0, candidates.size()});
    candidates[at->second].power += emitted[i];
  }
  if (candidates.empty()) return;
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.power != b.power ? a.power > b.power : a.order < b.order;
  });
  if (candidates.size() > kMaxGroups - 1) candidates.resize(kMaxGroups - 1);
  std::vector<Group> groups(1);
  known.clear();
  for (const Candidate& c : candidates) {
    known[c.modulation] = groups.size();
    groups.emplace_back();
    groups.back().modulation = c.modulation, groups.back().mean = c.mean;
  }
  group_of_.assign(lights.size(), 0);
  for (std::size_t i = 0; i < lights.size(); ++i)
    if (const auto found = known.find(lights[i].emitter->modulation()); found != known.end())
      group_of_[i] = std::uint32_t(found->second);
  group_leaf_.resize(parts_.size());
  std::vector<std::vector<EmissionBounds>> leaves(groups.size());
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    const std::uint32_t g = group_of_[parts_[k].first->index];
    group_leaf_[k] = groups[g].parts.size();
    groups[g].parts.push_back(k);
    leaves[g].push_back(bounds[k]);
  }
  for (std::size_t k = 0; k < sources_.size(); ++k) {
    Group& g = groups[group_of_[sources_[k].first->index]];
    g.sources.push_back(k);
    g.power_sums.push_back((g.power_sums.empty() ? 0 : g.power_sums.back()) + power_sums_[k] -
                           (k > 0 ? power_sums_[k - 1] : 0));
  }
  for (std::size_t g = 0; g < groups.size(); ++g) groups[g].tree = LightTree(std::move(leaves[g]));
  groups_ = std::move(groups);
}

LightSampler::TimeWeights LightSampler::weights_at(const Vec3& p, const Vec3& n, float time) const {
  TimeWeights w;
  float mean = 0, present = 0;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    const float estimate = groups_[g].tree.estimate(p, n);
    w.brightness[g] = groups_[g].brightness(time);
    w.trees[g] = estimate * w.brightness[g];
    mean += estimate, present += w.trees[g];
  }
  // All trees together have the weight 1 where they are as bright as in the mean over time, beside lights at infinity.
  w.total = 0;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    w.trees[g] = mean > 0 && present > 0 ? w.trees[g] / mean : 0.f;
    w.total += w.trees[g];
  }
  for (const Light* light : infinite_)
    w.total += light->sampling_weight() * w.brightness[group_of_[light->index]];
  return w;
}

std::optional<LightChoice> LightSampler::choose_at(const Vec3& p, const Vec3& n, float u, float time) const {
  const TimeWeights w = weights_at(p, n, time);
  if (!(w.total > 0)) return {};
  float at = u * w.total, rest = 0;
  // Rounding may leave a remainder behind the last candidate, which is then chosen.
  const Light* infinite = nullptr;
  const Group* group = nullptr;
  float weight = 0;
  for (const Light* light : infinite_) {
    const float own = light->sampling_weight() * w.brightness[group_of_[light->index]];
    if (!(own > 0)) continue;
    infinite = light, weight = own;
    if (at < own) return LightChoice{light, 0, own / w.total};
    at -= own;
  }
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    if (!(w.trees[g] > 0)) continue;
    group = &groups_[g], weight = w.trees[g];
    rest = at / weight;
    if (at < weight) break;
    at -= weight;
  }
  if (!group) return LightChoice{infinite, 0, weight / w.total};
  const auto leaf = group->tree.choose(p, n, std::clamp(rest, 0.f, 0x1.fffffep-1f), weight / w.total);
  if (!leaf) return {};
  const auto& [light, part] = parts_[group->parts[leaf->leaf]];
  return LightChoice{light, part, leaf->probability};
}

const EmissionBounds* LightSampler::choose_along(const Ray& ray, float t_max, float u, float time) const {
  const LightTree* tree = &tree_;
  if (!groups_.empty()) {
    std::array<float, kMaxGroups> weights;
    float total = 0;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      const float brightness = groups_[g].brightness(time);
      weights[g] = brightness > 0 ? brightness * groups_[g].tree.estimate_along(ray, t_max) : 0;
      total += weights[g];
    }
    if (!(total > 0)) return nullptr;
    float at = u * total;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      if (!(weights[g] > 0)) continue;
      // Rounding may leave a remainder behind the last group, which is then chosen.
      tree = &groups_[g].tree, u = std::min(at / weights[g], 0x1.fffffep-1f);
      if (at < weights[g]) break;
      at -= weights[g];
    }
  }
  const auto leaf = tree->choose_along(ray, t_max, u);
  return leaf ? &tree->leaf(*leaf) : nullptr;
}

float LightSampler::probability_at(const Vec3& p, const Vec3& n, const Light& light, std::size_t part,
                                   float time) const {
  const std::size_t first = first_leaf_[light.index];
  if (light.is_infinite() ? std::find(infinite_.begin(), infinite_.end(), &light) == infinite_.end()
                          : first == kNone)
    return 0;
  const TimeWeights w = weights_at(p, n, time);
  if (!(w.total > 0)) return 0;
  const std::uint32_t g = group_of_[light.index];
  if (light.is_infinite()) return light.sampling_weight() * w.brightness[g] / w.total;
  return w.trees[g] > 0 ? groups_[g].tree.probability(p, n, group_leaf_[first + part], w.trees[g] / w.total)
                        : 0.f;
}

std::optional<LightChoice> LightSampler::choose_by_power(Vec2 u, float time) const {
  if (groups_.empty()) return choose_by_power(u);
  std::array<double, kMaxGroups> brightness{};
  double total = 0;
  for (std::size_t g = 0; g < groups_.size(); ++g)
    if (!groups_[g].sources.empty()) {
      brightness[g] = double(groups_[g].brightness(time));
      total += brightness[g] * groups_[g].power_sums.back();
    }
  if (!(total > 0)) return {};
  double at = std::min(double(u.x) + double(u.y) * 0x1p-24, 1 - 0x1p-53) * total;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    const Group& group = groups_[g];
    const double power = group.sources.empty() ? 0 : brightness[g] * group.power_sums.back();
    if (!(power > 0)) continue;
    if (at >= power) {
      at -= power;
      continue;
    }
    const std::vector<double>& sums = group.power_sums;
    const std::size_t i =
        std::min(std::size_t(std::upper_bound(sums.begin(), sums.end(), at / brightness[g]) - sums.begin()),
                 sums.size() - 1);
    const auto& [light, part] = sources_[group.sources[i]];
    return LightChoice{light, part, float(brightness[g] * (sums[i] - (i > 0 ? sums[i - 1] : 0)) / total)};
  }
  return {};
}

float LightSampler::probability_by_power(const Light& light, std::size_t part, float time) const {
  if (groups_.empty()) return probability_by_power(light, part);
  const std::size_t first = first_source_[light.index];
  if (first == kNone) return 0;
  double total = 0;
  for (const Group& g : groups_)
    if (!g.sources.empty()) total += double(g.brightness(time)) * g.power_sums.back();
  const std::size_t k = first + part;
  const double power = power_sums_[k] - (k > 0 ? power_sums_[k - 1] : 0);
  return total > 0 ? float(double(groups_[group_of_[light.index]].brightness(time)) * power / total) : 0.f;
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
