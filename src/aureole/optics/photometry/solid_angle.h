// SPDX-License-Identifier: Apache-2.0
// Solid angles and projected solid angles of spheres, discs and polygons, and the conversions of radiometric quantities that
// follow from them.
#pragma once

#include <array>
#include <span>

namespace aureole::optics {

using Point3 = std::array<double, 3>;

/// A solid angle [sr], and its integral weighted by the cosine with a normal above the plane of that normal [sr].
struct SolidAngles {
  double solid = 0, projected = 0;
};

// Points are relative to the observer, in any unit. `normal` has any length; zero: `projected` stays 0.
// All functions throw std::domain_error for numbers that describe no shape.

/// A sphere at a distance of more than its radius; within it the solid angle is 4 pi. The projected solid angle of a sphere
/// that the plane cuts: J. M. Snyder, "Area light sources for real-time graphics", 1996.
SolidAngles sphere_solid_angle(const Point3& center, double radius, const Point3& normal);

/// A flat disc, seen from either side: the solid angle by complete elliptic integrals (F. Paxton, "Solid angle calculation for
/// a circular disk", 1959, equations 5 to 7), the projected one by Lambert's integral over the boundary, which the plane cuts.
SolidAngles disc_solid_angle(const Point3& center, const Point3& axis, double radius, const Point3& normal);

/// A flat polygon without crossing sides, seen from either side: a sum over triangles (A. van Oosterom, J. Strackee, "The solid
/// angle of a plane triangle", 1983, equation 8), and Lambert's formula for the part above the plane (J. H. Lambert,
/// Photometria, 1760; P. Schroeder & P. Hanrahan 1993). Corners that lie in no plane make the surface of a fan about the
/// first one; parts of it that cover each other then count with their signs.
SolidAngles polygon_solid_angle(std::span<const Point3> corners, const Point3& normal);

}  // namespace aureole::optics
