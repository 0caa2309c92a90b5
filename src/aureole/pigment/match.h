// SPDX-License-Identifier: Apache-2.0
// Colour matching: recipes of a palette's paints for a target colour.
#pragma once

#include <limits>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "aureole/core/parallel_for.h"
#include "aureole/pigment/film_theory.h"
#include "aureole/pigment/observation.h"
#include "aureole/pigment/paints.h"

namespace aureole::pigment {

/// A colour to match. If its reflectance is given, at the palette's wavelengths, matches are also compared
/// under other illuminants.
struct MatchTarget {
  Lab lab;
  std::vector<double> reflectance = {};
};

/// The quantity that a recipe minimises.
enum class MatchBy {
  colour,   ///< CIEDE2000 under the first illuminant
  lamps,    ///< the sum of squares of CIEDE2000 under all illuminants
  spectrum  ///< the rms difference in reflectance
};

struct MatchSettings {
  int max_paints = 3;
  int solutions = 5;                          ///< largest number of recipes, each with a different set of
                                              ///< paints
  std::vector<double> least = {}, most = {};  ///< bounds of each pigment's mass fraction; empty: 0 and 1
  double thickness = std::numeric_limits<double>::infinity();
  /// Inner reflectance, one value or one per wavelength; needed if the layer is not opaque.
  std::vector<double> substrate = {};
  MatchBy by = MatchBy::colour;
  /// Pairs of pigments, by index, that must not occur together.
  std::vector<std::pair<std::size_t, std::size_t>> forbidden = {};
  /// Smallest amount of a paint that can be dosed. A paint wanted in less is tried at this amount.
  double smallest = 1e-4;
  /// Cost of each pigment per mass, in any unit; empty: not known.
  std::vector<double> price = {};
  /// Smallest contrast ratio over black and over `white_below`, at a finite thickness; 0: any.
  double least_contrast = 0;
  double white_below = 0.8;  ///< inner reflectance of the white card of contrast ratios
  /// Returns the recipes of which no other one is better in colour difference, cost and metamerism at once, of those
  /// whose difference is at most `within`, rather than the best in colour difference.
  bool trade_offs = false;
  double within = 1;
};

/// A recipe and its colour.
struct Match {
  std::vector<double> fractions;  ///< mass fractions, one per pigment of the palette
  Lab lab;
  double difference = 0;  ///< CIEDE2000 to the target under the first illuminant
  /// CIEDE2000 under the other illuminants, if the target has a reflectance: metamerism
  std::vector<double> differences;
  double rms = 0;  ///< rms of the difference in reflectance, if the target has one
  std::vector<double> reflectance;
  double cost = 0;      ///< cost per mass of the mixture; 0 without prices
  double contrast = 1;  ///< ratio of luminous reflectances over black and over white; 1 for opaque layers
  /// CIEDE2000 from this recipe if one paint is dosed 1 % too high, one per pigment, followed by the
  /// difference for independent 1 % errors of all paints (root of the sum of squares).
  std::vector<double> dosing = {};
  double dosing_error = 0;

  /// Returns the largest difference under the other illuminants.
  double metamerism() const;
};

/// Returns the best recipes of at most `max_paints` paints (1 to 6), best first. They are sorted by the
/// quantity `by` in steps of 0.005, then by the largest difference under the other illuminants, then by the
/// number of paints.
///
/// Sets of up to three paints are all tried, by damped least squares from several starting points within the bounds,
/// so that the result is never worse than the best single paint; larger sets also if there are at most 1200 sets.
/// Otherwise a larger set is tried if adding a paint to the best recipe of its subsets brings the colour nearer.
/// Amounts below `smallest` occur only where a paint's lower bound is positive and smaller. Negative K and S of the
/// palette count as zero. More than four paints can match one colour in many ways, of which one is found. A least
/// contrast ratio is a constraint, met by the method of multipliers (Nocedal & Wright, Numerical Optimization, 2006,
/// algorithm 17.4). Throws std::domain_error for bounds that no recipe satisfies, for a contrast ratio that none has,
/// for more than two million sets, and for illuminants and targets whose wavelengths differ from the palette's.
/// Recipes of a palette that was fitted by streams are predicted by streams: by `theory`, or, if that is null, by
/// `theory_of` the palette.
std::vector<Match> match(const Palette& palette, const MatchTarget& target, const Observation& lamp,
                         std::span<const Observation> others = {}, const MatchSettings& settings = {},
                         const ParallelFor& parallel_for = serial_for,
                         std::shared_ptr<const FilmTheory> theory = {});

}  // namespace aureole::pigment
