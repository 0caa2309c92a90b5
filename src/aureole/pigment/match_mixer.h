// SPDX-License-Identifier: Apache-2.0
// The inner problem of a match: the best fractions of a few chosen paints, by damped least squares on the simplex.
#pragma once

#include <array>
#include <vector>

#include "aureole/pigment/match.h"

namespace aureole::pigment {

inline constexpr int kMaxPaints = 6;
/// Fractions of the chosen paints, in their order.
using Shares = std::array<double, kMaxPaints>;

/// A match at some wavelengths: those of the palette, or groups of them for a first search.
struct MatchProblem {
  Palette palette;
  MatchTarget target;
  std::vector<Observation> lamps;  ///< the first, then the others
  MatchSettings settings;          ///< with bounds for each pigment
};

/// The problem at means over `group` neighbouring wavelengths.
MatchProblem grouped(const MatchProblem& problem, std::size_t group);

/// Mixtures of some paints of a palette, used by one thread.
class Mixer {
public:
  explicit Mixer(const MatchProblem& problem);

  void choose(std::vector<std::size_t> paints) { paints_ = std::move(paints); }
  std::size_t size() const { return paints_.size(); }
  double least(std::size_t i) const { return problem_.settings.least[paints_[i]]; }
  double most(std::size_t i) const { return problem_.settings.most[paints_[i]]; }

  /// Outer reflectance of the layer that the settings describe.
  const std::vector<double>& reflectance(const Shares& shares);
  /// Luminous reflectance over black divided by that over white; 1 for an opaque layer.
  double contrast(const Shares& shares);
  /// The least-squares problem: numbers whose squares sum to what the match minimises.
  const std::vector<double>& residual(const Shares& shares);
  double value(const Shares& shares);

  /// Fractions with the bounds and a sum of one: all are shifted by an equal amount and clamped.
  Shares projected(const Shares& shares) const;
  /// Levenberg-Marquardt method from `shares`, which become the best ones found. Returns their value.
  double descend(Shares& shares);
  /// The best fractions from several starting points.
  Shares best();

private:
  void mix(const Shares& shares);
  void find_layers();
  double contrast_of_layers();

  const MatchProblem& problem_;
  std::vector<std::size_t> paints_;
  std::vector<LayerTransfer> layers_;
  std::vector<double> k_, s_, reflectance_, residual_, here_, slopes_;
};

}  // namespace aureole::pigment
