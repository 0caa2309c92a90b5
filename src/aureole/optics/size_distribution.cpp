// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/size_distribution.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <istream>
#include <sstream>
#include <stdexcept>
#include <string>

namespace aureole::optics {

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
  // Rings of neighbouring sizes overlap up to u = 60 or so, beyond which the spread has smoothed them.
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
  std::string line;
  for (int number = 1; std::getline(text, line); ++number) {
    line.resize(std::min(line.find('#'), line.size()));
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    words.imbue(std::locale::classic());
    std::string first;
    if (!(words >> first)) continue;
    const auto fail = [&](const std::string& what) {
      throw std::domain_error("line " + std::to_string(number) + " of the histogram: " + what);
    };
    if (nodes.empty() && std::isalpha(static_cast<unsigned char>(first[0])) && first != "nan" &&
        first != "inf")
      continue;
    std::istringstream one(first);
    one.imbue(std::locale::classic());
    Node n{};
    std::string rest;
    if (!(one >> n.size) || !one.eof() || !(words >> n.weight) || (words >> rest))
      fail("expected a size and a count, got \"" + line + "\"");
    if (!(n.size > 0 && std::isfinite(n.size))) fail("a size must be positive and finite");
    if (!(n.weight >= 0 && std::isfinite(n.weight))) fail("a count must not be negative");
    if (n.weight > 0) nodes.push_back(n);
    if (nodes.size() > 10000) fail("has more than 10000 sizes");
  }
  if (nodes.empty()) throw std::domain_error("the histogram has no size with a positive count");
  return SizeDistribution(std::move(nodes));
}

double SizeDistribution::moment(int power) const {
  double sum = 0;
  for (const Node& n : nodes_) sum += n.weight * std::pow(n.size, power);
  return sum;
}

}  // namespace aureole::optics
