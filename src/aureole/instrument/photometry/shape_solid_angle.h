// SPDX-License-Identifier: Apache-2.0
// The solid angle of any shapes from a point, by rays.
#pragma once

#include <functional>

#include "aureole/scene/scene.h"

namespace aureole {

/// Solid angle and projected solid angle [sr] with their standard errors.
struct TracedSolidAngle {
  double solid = 0, projected = 0, solid_error = 0, projected_error = 0;
};

/// The directions in which a ray from `p` hits a shape of the scene, whatever its material: the solid angle of all shapes
/// together, and, unless `normal` is zero, its integral weighted by the cosine above the plane. `samples` rays go into the
/// cone about the bounding sphere of the scene, in 16 rotations of a lattice, from which the errors follow. Throws Error for a
/// scene without shapes. `between` is called now and then, and may throw.
TracedSolidAngle traced_solid_angle(const Scene& scene, const Vec3& p, const Vec3& normal, int samples,
                                    const std::function<void()>& between = {});

}  // namespace aureole
