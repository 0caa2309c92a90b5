// SPDX-License-Identifier: Apache-2.0
// Where an emitter's own coordinates lie in the world.
#pragma once

#include "aureole/math/vec.h"

namespace aureole {

class Properties;

/// The emitter's origin and axes (right-handed or not) in the world.
struct Placement {
  Vec3 origin;
  Frame axes;
  double scale = 1;  ///< length of the axes before they were made unit vectors
};

/// From `to_world`. It may move, turn, mirror and scale; shearing and stretching, which would change solid
/// angles, are errors.
Placement get_placement(const Properties& properties);

}  // namespace aureole
