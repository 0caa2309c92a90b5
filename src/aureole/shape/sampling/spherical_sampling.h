// SPDX-License-Identifier: Apache-2.0
// Sampling of plane figures by solid angle, without the variance that distance and cosine cause in area
// sampling. Computations are in double precision: the angles of a small spherical triangle sum to little more
// than pi.
#pragma once

#include "aureole/shape/mesh/mesh_patches.h"

namespace aureole {

/// Returns the unsigned solid angle of a triangle [sr] (van Oosterom & Strackee 1983, "The solid angle of a
/// plane triangle", eq. 8).
double triangle_solid_angle(const Vec3& reference, const TriangleCorners& corners);

/// Samples a point uniformly in the solid angle of a triangle; returns its barycentrics (b1, b2) (Arvo 1995,
/// "Stratified sampling of spherical triangles", section 3). `solid_angle` comes from `triangle_solid_angle`.
Vec2 sample_spherical_triangle(const Vec3& reference, const TriangleCorners& corners, double solid_angle,
                               Vec2 u);

/// Samples a point uniformly in the solid angle of a rectangle; returns its coordinates in [0, 1]^2 along the
/// edges (Ureña, Fajardo & King 2013, "An area-preserving parametrization for spherical rectangles", section
/// 4).
Vec2 sample_spherical_rectangle(const Vec3& reference, const Vec3& corner, const Vec3& along_x,
                                const Vec3& along_y, Vec2 u);

/// Returns the pdf of uniform area sampling, converted to solid angle from `reference` [1/sr]; 0 if the area
/// is edge-on.
inline float area_sampling_pdf(const Vec3& reference, const Vec3& p, const Vec3& ng, float area) {
  const Vec3 w = p - reference;
  const float distance_squared = dot(w, w), distance = std::sqrt(distance_squared),
              projected = std::abs(dot(w, ng));
  // Smaller cosines count as edge-on, since the normal is rounded to float.
  if (!(projected > 1e-7f * distance) || !(area > 0)) return 0;
  return distance_squared * distance / (projected * area);
}

/// The technique by which a patch is sampled from a reference point. The technique depends on patch and
/// reference point alone, so that sampling and pdf agree.
struct PatchView {
  enum class Technique { none, area, solid_angle };
  Technique technique = Technique::none;
  double solid_angle[2] = {0, 0};  ///< solid angle of each triangle

  double total() const { return solid_angle[0] + solid_angle[1]; }
  /// Whether the patch is so distant that uniform area and uniform solid angle differ little; area sampling
  /// has a sixth of the cost.
  static bool is_far(const Vec3& reference, const MeshPatch& patch) {
    return patch.longest_squared < kFar * length_squared(patch.center - reference);
  }
  /// `second` is null for a single triangle.
  static PatchView of(const Vec3& reference, const TriangleCorners& first, const TriangleCorners* second);

private:
  /// Where the patch's longest edge squared is below this share of the squared distance to its centroid,
  /// uniform area and uniform solid angle differ mostly by less than a third between its corners
  /// (docs/decisions/0014-lights-by-solid-angle.md).
  static constexpr float kFar = 1.5f;
};

}  // namespace aureole
