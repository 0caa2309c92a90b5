// SPDX-License-Identifier: Apache-2.0
// `IntensityMap`: U(u) and C(u) of a mixture that is not isotropic, tabulated over the plane for look-up in
// single precision.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "aureole/optics/scatterer_mixture.h"

namespace aureole::optics {

/// Nested grids, finer towards the centre: steps of 1/20 up to |ux|, |uy| = 8, 1/16 up to 16, 1/12 up to 32,
/// 1/5 up to 64 and 1/2 beyond, between which a point takes the bicubic interpolant (four-point Lagrange).
/// Transforms of a shape within a circle of radius 1 have no frequency above 2 and fall as 1/u or faster: the
/// error stays below 1e-5 of the peak (the tests measure it).
class IntensityMap {
public:
  struct Pair {
    float uncorrelated, coherent;
  };
  static constexpr int kLargestExtent = 240;

  /// `extent`: up to where |u| is wanted; at most kLargestExtent is tabulated. `f` is called from several
  /// threads.
  IntensityMap(const std::function<MixtureIntensity(double, double)>& f, double extent);

  /// |ux| and |uy| where the map ends. Beyond it `eval` must not be called.
  float extent() const { return levels_.back().extent; }
  Pair eval(float ux, float uy) const;
  std::size_t bytes() const;

private:
  struct Level {
    float extent, rate;  ///< rate: nodes per unit
    int columns;
    /// Nodes (U, C) for ux from -extent - step and uy from -step: the lower half plane is the upper one
    /// turned by 180 degrees.
    std::vector<Pair> nodes;
  };
  std::vector<Level> levels_;
};

}  // namespace aureole::optics
