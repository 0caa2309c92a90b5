// SPDX-License-Identifier: Apache-2.0
// Colour matching: recipes of a palette's paints for a target colour.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "aureole/core/parallel_for.h"
#include "aureole/pigment/observation.h"
#include "aureole/pigment/paints.h"

namespace aureole::pigment {

/// A colour to match. If its reflectance is given, at the palette's wavelengths, matches are also compared
/// under other illuminants.
struct MatchTarget {
  Lab lab;
  std::vector<double> reflectance = {};
};

struct MatchSettings {
  int max_paints = 3;
  int solutions = 5;                          ///< largest number of recipes, each with a different set of
                                              ///< paints
  std::vector<double> least = {}, most = {};  ///< bounds of each pigment's mass fraction; empty: 0 and 1
  double thickness = std::numeric_limits<double>::infinity();
  /// Inner reflectance, one value or one per wavelength; needed if the layer is not opaque.
  std::vector<double> substrate = {};
};

/// A recipe and its colour.
struct Match {
  std::vector<double> fractions;  ///< by mass, one per pigment of the palette
  Lab lab;
  double difference = 0;            ///< CIEDE2000 to the target under the first illuminant
  std::vector<double> differences;  ///< under the other illuminants, if the target has a reflectance:
                                    ///< metamerism
  double rms = 0;                   ///< of the difference in reflectance, if the target has one
  std::vector<double> reflectance;
};

/// Returns the best recipes of at most `max_paints` paints (1 to 6), best first. They are sorted by the
/// colour difference under `lamp` in steps of 0.005, then by the largest difference under the other
/// illuminants, then by the number of paints. Every set of paints is tried, by damped least squares from
/// several starting points within the bounds, so that the result is never worse than the best single paint.
/// Amounts below 1e-4 are dropped if the bounds allow it. Negative K and S of the palette count as zero. More
/// than four paints can match one colour in many ways, of which one is found. Throws std::domain_error for
/// bounds that no recipe satisfies, and for illuminants and targets whose wavelengths differ from the
/// palette's.
std::vector<Match> match(const Palette& palette, const MatchTarget& target, const Observation& lamp,
                         std::span<const Observation> others = {}, const MatchSettings& settings = {},
                         const ParallelFor& parallel_for = serial_for);

}  // namespace aureole::pigment
