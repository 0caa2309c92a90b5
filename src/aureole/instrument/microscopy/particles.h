// SPDX-License-Identifier: Apache-2.0
// Measurements of each particle of a segmented field. Lengths are in pixels; x is to the right, y down.
#pragma once

#include <array>
#include <vector>

#include "aureole/instrument/microscopy/observation_window.h"
#include "aureole/instrument/microscopy/segmentation.h"

namespace aureole {

using Outline = std::vector<std::array<double, 2>>;

struct Particle {
  int field = 0;
  double x = 0, y = 0;     ///< centroid
  double area = 0;         ///< area from grey values: edge pixels count by their covered fraction
  double radius = 0;       ///< radius of the circle of equal area
  double circularity = 0;  ///< 4 pi area/perimeter^2 of the outline; 1 for a circle
  double aspect = 1;       ///< ratio of the axes of the ellipse with the same second moments, >= 1
  double angle = 0;        ///< angle of the ellipse's long axis from x towards y, degrees in [0, 180)
  double reach = 0;        ///< half the side of the smallest square around the particle and its edge
  bool cut = false;        ///< whether the square of `reach` extends beyond the window
  bool touching = false;   ///< shares a boundary with another particle
  Outline outline;         ///< outline at level 1/2, counter-clockwise with y up; empty for cut particles
};

/// Measures all particles of a field, in order of their labels.
std::vector<Particle> measure_particles(const Segmentation& field, const ObservationWindow& window,
                                        int index);

}  // namespace aureole
