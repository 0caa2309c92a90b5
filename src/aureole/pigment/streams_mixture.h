// SPDX-License-Identifier: Apache-2.0
// Mixtures of paints whose K and S were fitted by streams, predicted by streams as well.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "aureole/pigment/film_theory.h"
#include "aureole/pigment/paints.h"

namespace aureole::pigment {

class StreamsMixture {
public:
  /// Tabulates the theory (`streams_theory`). Throws std::domain_error for a palette that was not fitted by streams.
  explicit StreamsMixture(Palette palette, const ParallelFor& threads = serial_for);

  /// Outer reflectance of a layer, by mass fractions that sum to one, as the instrument of `Palette::streams` measures it.
  /// K and S add up as in `mix`. So do sigma_s, proportional to S/(1 - g), of paints with mean cosines of their own.
  /// `thickness` is in the inverse unit of K and S and may be infinite; the substrate is then ignored. K and S below 1e-12
  /// per layer count as 1e-12. Throws std::domain_error as `mix` does.
  std::vector<double> reflectance(std::span<const double> fractions, double thickness,
                                  Substrate substrate) const;

private:
  Palette palette_;
  std::unique_ptr<FilmTheory> theory_;
};

}  // namespace aureole::pigment
