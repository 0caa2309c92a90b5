// SPDX-License-Identifier: Apache-2.0
// Finds the bodies of a scene that touch other surfaces or cut other bodies. A ray leaves a surface from an
// origin that lies off it by the bound of the rounding error, and would skip any surface within that
// distance: where two cubes touch, the ray that leaves one cube would never enter the other. Surfaces that
// `touches` marks are treated together at run time (transport/contact.h). Bodies that touch or cut each other
// get a rank, by which a path's interior list knows which of them contain the path (scene/interior_list.h).
#pragma once

#include <string>
#include <vector>

#include "aureole/scene/scene_parts.h"
#include "aureole/scene/scene_surfaces.h"

namespace aureole {

/// Distance along the unit direction `d` from a surface within which other surfaces count as touching it: twice
/// the distance by which a ray's origin is moved off the surface.
inline float contact_distance(const SurfacePoint& point, const Vec3& d) {
  // upper bound of the grazing angle: more grazing rays would skip other parts of curved surfaces
  constexpr float kMinCosine = 1 / 64.f;
  return 2 * offset_distance(point) / std::max(std::abs(dot(point.ng, d)), kMinCosine);
}

struct Contacts {
  bool any = false;                ///< whether any surface touches another one
  Bounds3 ranked;                  ///< bounds of the bodies with a rank
  std::vector<std::string> notes;  ///< notes for the user on cases that cannot be decided
};

/// Marks the surfaces that touch others, and ranks bodies that touch or cut each other: a body within another
/// one ranks above it; of two bodies that cut each other the first in the scene ranks above the second, which
/// is noted unless they are of equal matter. Numbers all bodies that have a rank. The search uses rays
/// through the common bounds of each pair of bodies, 4 to 256 along each axis; contacts that cover a smaller
/// part of these bounds may not be found.
Contacts find_contacts(const SceneParts& parts, SceneSurfaces& surfaces);

/// Whether two surfaces have the same index of refraction within.
bool have_same_index(const Surface& a, const Surface& b, const Wavelengths& w);

}  // namespace aureole
