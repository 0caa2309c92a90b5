// SPDX-License-Identifier: Apache-2.0
// Samples directions of a luminaire in proportion to its intensity.
#pragma once

#include <vector>

#include "aureole/math/piecewise.h"
#include "aureole/math/vec.h"
#include "aureole/optics/photometry/intensity_distribution.h"

namespace aureole {

/// A piecewise constant pdf over cells of azimuth and polar angle, each proportional to the mean intensity at the
/// corners of the cell times its solid angle. It is positive wherever the intensity is.
class IntensitySampler {
public:
  explicit IntensitySampler(const optics::IntensityDistribution& distribution);

  /// A unit direction in the luminaire's coordinates and its pdf [1/sr]; a pdf of 0: nothing was sampled.
  Vec3 sample(Vec2 u, float* pdf) const;
  float pdf(const Vec3& local) const;

private:
  double solid_angle(std::size_t column, std::size_t row) const;

  optics::PhotometricAxes axes_;
  std::vector<double> azimuths_,
      cosines_;  ///< bounds of the cells [rad], and cosines of polar angles, decreasing
  Piecewise2D cells_;
};

}  // namespace aureole
