// SPDX-License-Identifier: Apache-2.0
// The position and orientation of an emitter's local coordinates in the world.
#pragma once

#include "aureole/math/motion.h"
#include "aureole/math/vec.h"

namespace aureole {

class Properties;

/// The emitter's origin and axes (right-handed or not) in the world.
struct Placement {
  Vec3 origin;
  Frame axes;
  double scale = 1;  ///< length of the axes before normalisation
};

/// Returns the placement given by `to_world`. It may move, turn, mirror and scale. Shearing and non-uniform
/// scaling, which would change solid angles, are errors.
Placement get_placement(const Properties& properties);
/// The placement by a transform that comes from `to_world`.
Placement get_placement(const Properties& properties, const Transform& to_world);

/// Returns the key frames of `to_world`. They may turn and move the emitter; scaling it from one to the next is an error.
Motion get_placement_motion(const Properties& properties);

}  // namespace aureole
