// SPDX-License-Identifier: Apache-2.0
// The inner problem of a match: the best fractions of a few chosen paints, by damped least squares on the simplex.
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <vector>

#include "aureole/pigment/film_theory.h"
#include "aureole/pigment/match.h"

namespace aureole::pigment {

inline constexpr int kMaxPaints = 6;
/// The value of a set of paints without a recipe.
inline constexpr double kNoRecipe = std::numeric_limits<double>::infinity();
/// Fractions of the chosen paints, in their order.
using Shares = std::array<double, kMaxPaints>;

/// A match at some wavelengths: those of the palette, or groups of them for a first search.
struct MatchProblem {
  Palette palette;
  MatchTarget target;
  std::vector<Observation> lamps;  ///< the first, then the others
  MatchSettings settings;          ///< with bounds for each pigment
  /// The theory that the palette's K and S were fitted by; null for two fluxes.
  std::shared_ptr<const FilmTheory> theory = {};
  /// Opaque layers of `theory`, if no paint has a mean cosine of its own.
  std::shared_ptr<const OpaqueReflectance> opaque = {};
  /// A set of paints whose largest contrast ratio is below the least one by no more than this is kept, at its largest
  /// contrast ratio: for a search at groups of wavelengths, whose contrast ratios are not exact.
  double contrast_slack = 0;
};

/// The problem at means over `group` neighbouring wavelengths.
MatchProblem grouped(const MatchProblem& problem, std::size_t group);

/// Mixtures of some paints of a palette, used by one thread.
class Mixer {
public:
  explicit Mixer(const MatchProblem& problem);

  /// Chooses the paints, with the bounds of the settings.
  void choose(std::vector<std::size_t> paints);
  std::size_t size() const { return paints_.size(); }
  double least(std::size_t i) const { return low_[i]; }
  double most(std::size_t i) const { return high_[i]; }
  /// Changes the bounds of a paint until the next choice. Returns whether the bounds allow a recipe.
  bool bound(std::size_t i, double least, double most);

  /// Outer reflectance of the layer that the settings describe.
  const std::vector<double>& reflectance(const Shares& shares);
  /// Luminous reflectance over black divided by that over white; 1 for an opaque layer.
  double contrast(const Shares& shares);
  /// The sum of squares that the match minimises.
  double value(const Shares& shares);

  /// Fractions within the bounds and with a sum of one: the parts above the lower bounds are scaled by one factor, and
  /// those that would exceed their upper bounds are set to these.
  Shares projected(const Shares& shares) const;
  /// The shares if their contrast ratio is large enough. Otherwise a point with the least contrast ratio on the line to
  /// a recipe that hides well, if there is one.
  Shares hiding(const Shares& shares) { return hiding(shares, 1e-7); }

  /// The best fractions from several starting points, and with each of the active bounds fixed. Returns their value,
  /// which is infinite if the chosen paints cannot have the least contrast ratio within the bounds.
  double best(Shares& shares);
  /// The best fractions near `shares`. Returns their value, as `best`.
  double refine(Shares& shares);
  /// The largest contrast ratio of the chosen paints found so far; if `best` or `refine` returned infinity,
  /// it is the largest possible one.
  double largest_contrast() const { return largest_contrast_; }

private:
  /// The kind of numbers that `residual` returns.
  enum class Aim { colour, hiding_colour, contrast };

  /// Finds K and S, and `FilmLayer::g_shift` where the theory has mean cosines of the paints.
  void mix(const Shares& shares);
  /// Finds the light of the layer of K and S at each wavelength, by two fluxes or by the problem's theory.
  void find_layers();
  double contrast_of_layers();
  /// Finds the point on the line to a relative error of its distance.
  Shares hiding(const Shares& shares, double error);
  bool hides(const Shares& shares) { return limit_ <= 0 || contrast(shares) >= limit_; }
  /// Returns numbers whose sum of squares is minimised.
  const std::vector<double>& residual(const Shares& shares);
  /// Levenberg-Marquardt method within the bounds from `shares`, which become the best ones found. Returns the sum of
  /// squares.
  double descend(Shares& shares, int most_steps = 60);
  /// Solves for the step of `descend` within the bounds. `rest` is the paint whose fraction makes the sum one.
  Shares stepped(const Shares& shares, const Shares& slope, const std::array<Shares, kMaxPaints>& normal,
                 std::array<bool, kMaxPaints> free, std::size_t rest, double damping) const;
  /// Descends at the least contrast ratio: the method of multipliers (augmented Lagrangian). Returns the value.
  double descend_hiding(Shares& shares);
  /// Points of a coarse grid of ratios.
  std::vector<Shares> grid() const;
  /// Finds a recipe with the least contrast ratio. Returns false if there is none.
  bool find_opaque();
  double best_of_grid(Shares& shares);

  const MatchProblem& problem_;
  std::vector<std::size_t> paints_;
  Shares low_{}, high_{};  ///< bounds of the chosen paints
  Aim aim_ = Aim::colour;
  double limit_ = 0;  ///< required contrast ratio
  /// Weight of a missing contrast ratio, and the multiplier as a shift of the limit.
  double weight_ = 0, shift_ = 0;
  Shares opaque_{};  ///< a recipe with the required contrast ratio, if `has_opaque_`
  bool has_opaque_ = false;
  double largest_contrast_ = 0;
  std::vector<FilmLight> layers_;
  bool has_g_ = false;  ///< whether paints have mean cosines of their own
  std::vector<double> k_, s_, g_shift_, reflectance_, residual_, here_, slopes_;
};

}  // namespace aureole::pigment
