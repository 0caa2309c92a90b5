// SPDX-License-Identifier: Apache-2.0
// Size distributions of scatterers, as nodes and weights for sums over sizes. Sizes are relative to a nominal
// shape and dimensionless.
#pragma once

#include <iosfwd>
#include <vector>

namespace aureole::optics {

class SizeDistribution {
public:
  struct Node {
    double size, weight;
  };
  static constexpr double kMaxSpread = 0.7;

  /// Makes a distribution with the single size 1.
  SizeDistribution() : nodes_{{1, 1}} {}

  /// Log-normal with median 1; `sigma` in [0, kMaxSpread] is the standard deviation of ln(size). The
  /// distribution is cut at 3 sigma and renormalised; nodes are midpoints of equal steps in ln(size). Throws
  /// std::domain_error.
  static SizeDistribution log_normal(double sigma);

  /// A histogram from lines of "size count" in the format of `read_two_columns`; more than 64 sizes are
  /// grouped. Throws std::domain_error for invalid lines or values.
  static SizeDistribution histogram(std::istream& text);

  /// Returns nodes in increasing order of size; their weights sum to 1.
  const std::vector<Node>& nodes() const { return nodes_; }
  double largest() const { return nodes_.back().size; }
  bool is_single() const { return nodes_.size() == 1; }
  /// Returns the mean of size^power.
  double moment(int power) const;

private:
  explicit SizeDistribution(std::vector<Node> nodes);
  std::vector<Node> nodes_;
};

}  // namespace aureole::optics
