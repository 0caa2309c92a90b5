// SPDX-License-Identifier: Apache-2.0
// Recipes for a colour: which paints of a palette, and how much of each.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "aureole/core/parallel_for.h"
#include "aureole/pigment/observation.h"
#include "aureole/pigment/paints.h"

namespace aureole::pigment {

/// A colour to match. With its reflectance, at the palette's wavelengths, matches are also compared under
/// other lamps.
struct MatchTarget {
  Lab lab;
  std::vector<double> reflectance = {};
};

struct MatchSettings {
  int max_paints = 3;
  int solutions = 5;                          ///< at most, of different sets of paints
  std::vector<double> least = {}, most = {};  ///< bounds of each pigment's mass fraction; empty: 0 and 1
  double thickness = std::numeric_limits<double>::infinity();
  /// Inner reflectance, one or one for each wavelength, where not opaque.
  std::vector<double> substrate = {};
};

/// A recipe and its colour.
struct Match {
  std::vector<double> fractions;  ///< by mass, one for each pigment of the palette
  Lab lab;
  double difference = 0;            ///< CIEDE2000 to the target under the first lamp
  std::vector<double> differences;  ///< under the other lamps, where the target has a reflectance: metamerism
  double rms = 0;                   ///< of the difference in reflectance, where there is one
  std::vector<double> reflectance;
};

/// The best recipes of at most `max_paints` paints (1 to 6), best first: by the colour difference under
/// `lamp` in steps of .005, then by the largest one under the other lamps, then by the number of paints.
/// Every set of paints is tried, by damped least squares from several starts within the bounds, so that the
/// result is never worse than the best paint alone. Amounts below 1e-4 are left out where the bounds allow
/// it. Negative K and S of the palette count as zero. More than four paints can match one colour in many
/// ways, of which one is found. Throws std::domain_error for bounds that no recipe keeps and for lamps and
/// targets of other wavelengths than the palette's.
std::vector<Match> match(const Palette& palette, const MatchTarget& target, const Observation& lamp,
                         std::span<const Observation> others = {}, const MatchSettings& settings = {},
                         const ParallelFor& parallel_for = serial_for);

}  // namespace aureole::pigment
