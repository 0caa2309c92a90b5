// SPDX-License-Identifier: Apache-2.0
// `SplatProjector`: the footprints of the splats of one medium in the picture of a pinhole camera.
#pragma once

#include "aureole/integrator/splat/projected_splats.h"

namespace aureole {

/// The part of the picture that a footprint can reach, relative to its centre [pixels].
struct SplatReach {
  double x0, x1, y0, y1;
};

/// A vector in double precision: footprints far beside the picture are differences of large numbers.
struct SplatVector {
  double x = 0, y = 0, z = 0;
};

class SplatProjector {
public:
  /// `part` is the part of the film with positions of rays. Keeps references to all but `part`.
  SplatProjector(const SplatMedium& medium, const SplatSettings& settings,
                 const SplatConventions& conventions, const PinholeView& view, const FilmPart& part);

  /// Result of a projection; `outside`: before or behind the range of depths, or below the threshold of opacity; `no_area`:
  /// the projection is a line or a point.
  enum class Outcome { outside, no_area, visible };
  /// Projects a splat of the cloud. Sets the footprint without its colour, the depth by which it is sorted [length] and its reach.
  Outcome project(std::size_t index, SplatFootprint& footprint, float& depth, SplatReach& reach) const;
  /// Sets the colour of a footprint as it is seen from the camera.
  void set_color(std::size_t index, SplatFootprint& footprint) const;

private:
  /// Sets the exponent and the weight of a footprint by its `axes`, which map the unit sphere to the splat in camera space. `p`
  /// is the centre there, at `distance` from the camera.
  Outcome set_footprint(const SplatVector& p, double distance, const SplatVector axes[3],
                        SplatFootprint& footprint, SplatReach& reach) const;

  const SplatCloud& cloud_;
  const SplatSettings& settings_;
  const SplatConventions& conventions_;
  const PinholeView& view_;
  Transform::Matrix to_camera_;  ///< matrix from the axes of the cloud to the camera
  Transform::Matrix turn_;       ///< the rotation of the world to the axes of the cloud
  Transform::Matrix to_world_;
  SplatVector eye_;  ///< position of the camera in world space
  double near_, cutoff_;
  bool compensates_;
  double lower_x_, upper_x_, lower_y_, upper_y_;  ///< limits of x / z and y / z of the linearisation
};

}  // namespace aureole
