// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/particle/size_distribution.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "aureole/optics/two_columns.h"

namespace aureole::optics {

namespace {

constexpr std::size_t kMaxNodes = 64;

/// Groups sizes in equal steps of ln(size); a group has the root mean square of its sizes.
std::vector<SizeDistribution::Node> grouped(std::vector<SizeDistribution::Node> nodes) {
  const auto [least, most] = std::minmax_element(
      nodes.begin(), nodes.end(), [](const auto& a, const auto& b) { return a.size < b.size; });
  const double first = std::log(least->size),
               step = std::max((std::log(most->size) - first) / kMaxNodes, 1e-12);
  std::vector<SizeDistribution::Node> groups(kMaxNodes, {0, 0});
  for (const auto& n : nodes) {
    auto& g = groups[std::min(std::size_t((std::log(n.size) - first) / step), kMaxNodes - 1)];
    g.size += n.weight * n.size * n.size, g.weight += n.weight;
  }
  std::erase_if(groups, [](const auto& g) { return !(g.weight > 0); });
  for (auto& g : groups) g.size = std::sqrt(g.size / g.weight);
  return groups;
}

}  // namespace

SizeDistribution::SizeDistribution(std::vector<Node> nodes) : nodes_(std::move(nodes)) {
  std::sort(nodes_.begin(), nodes_.end(), [](const Node& a, const Node& b) { return a.size < b.size; });
  double sum = 0;
  for (const Node& n : nodes_) sum += n.weight;
  for (Node& n : nodes_) n.weight /= sum;
}

SizeDistribution SizeDistribution::log_normal(double sigma) {
  if (!(sigma >= 0 && sigma <= kMaxSpread))
    throw std::domain_error("spread of sizes must be in [0, 0.7], got " + std::to_string(sigma));
  if (sigma == 0) return {};
  constexpr double kCut = 3;
  // Number of nodes: rings of neighbouring sizes overlap up to about u = 60, beyond which the spread has
  // smoothed them.
  const int count = std::clamp(int(std::ceil(2 * kCut * sigma * 60)), 15, 63);
  std::vector<Node> nodes;
  for (int i = 0; i < count; ++i) {
    const double x = kCut * (2 * (i + 0.5) / count - 1);
    nodes.push_back({std::exp(sigma * x), std::exp(-0.5 * x * x)});
  }
  return SizeDistribution(std::move(nodes));
}

SizeDistribution SizeDistribution::histogram(std::istream& text) {
  std::vector<Node> nodes;
  for (const auto& [size, count] : read_two_columns(text)) {
    const auto fail = [&](const std::string& what) {
      throw std::domain_error(what + ", got " + std::to_string(size) + " " + std::to_string(count));
    };
    if (!(size > 0 && std::isfinite(size))) fail("a size must be positive and finite");
    if (!(count >= 0 && std::isfinite(count))) fail("a count must not be negative");
    if (count > 0) nodes.push_back({size, count});
  }
  if (nodes.empty()) throw std::domain_error("the histogram has no size with a positive count");
  if (nodes.size() > kMaxNodes) nodes = grouped(std::move(nodes));
  return SizeDistribution(std::move(nodes));
}

double SizeDistribution::moment(int power) const {
  double sum = 0;
  for (const Node& n : nodes_) sum += n.weight * std::pow(n.size, power);
  return sum;
}

}  // namespace aureole::optics
