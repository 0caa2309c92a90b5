// SPDX-License-Identifier: Apache-2.0
// The part of Mesh that area emitters use: its patches, sampled from a point.
#include "aureole/shape/double3.h"
#include "aureole/shape/mesh.h"
#include "aureole/shape/spherical_sampling.h"

namespace aureole {

namespace {

/// A point of a triangle by its barycentrics of vertices 1 and 2.
struct TriangleSample {
  std::uint32_t triangle;
  float b1, b2;
};

/// Barycentrics of a point uniform over the area.
Vec2 sample_triangle_area(Vec2 u) {
  const float s = std::sqrt(u.x);
  return {u.y * s, (1 - u.y) * s};
}

/// The point (x, y) in [0, 1]^2 of a parallelogram whose origin is the apex of its first triangle and whose
/// axes lead to the next two corners of that triangle.
TriangleSample parallelogram_point(const MeshPatch& patch, Vec2 at) {
  float b[3];
  const bool far = at.x + at.y > 1;
  const int k = patch.apex[far];
  if (far)  // the second triangle has the shared edge the other way around
    b[(k + 1) % 3] = 1 - at.x, b[(k + 2) % 3] = 1 - at.y, b[k] = at.x + at.y - 1;
  else
    b[(k + 1) % 3] = at.x, b[(k + 2) % 3] = at.y, b[k] = 1 - at.x - at.y;
  return {patch.triangle[far], b[1], b[2]};
}

}  // namespace

MeshPatch Mesh::patch(std::size_t index) const {
  if (!patches_.empty()) return patches_.patches[index];
  MeshPatch p;
  p.triangle[0] = std::uint32_t(index);
  p.measure(data_.positions, data_.triangles);
  return p;
}

std::size_t Mesh::patch_count() const {
  return patches_.empty() ? primitive_count() : patches_.patches.size();
}

std::size_t Mesh::patch_of_primitive(std::uint32_t primitive) const {
  return patches_.empty() ? primitive : patches_.of_triangle[primitive];
}

float Mesh::patch_area(std::size_t index) const { return patch(index).area; }

Bounds3 Mesh::patch_bounds(std::size_t index) const {
  Bounds3 b;
  const MeshPatch p = patch(index);
  for (const std::uint32_t t : p.triangle)
    if (t != MeshPatch::kNone)
      for (const Vec3& corner : corners(t)) b.extend(corner);
  return b;
}

std::pair<Vec3, float> Mesh::patch_normals(std::size_t index) const {
  return {point_at(patch(index).triangle[0], 0, 0).ng, 1.f};
}

PatchView Mesh::view(const Vec3& reference, const MeshPatch& p) const {
  if (PatchView::is_far(reference, p)) return {PatchView::Technique::area, {}};
  if (!p.is_pair()) return PatchView::of(reference, corners(p.triangle[0]), nullptr);
  const TriangleCorners second = corners(p.triangle[1]);
  return PatchView::of(reference, corners(p.triangle[0]), &second);
}

std::optional<ShapeSample> Mesh::sample_direct(const Vec3& reference, std::size_t index, Vec2 u) const {
  const MeshPatch p = patch(index);
  const PatchView seen = view(reference, p);
  if (seen.technique == PatchView::Technique::none) return std::nullopt;
  const bool by_area = seen.technique == PatchView::Technique::area;

  TriangleSample chosen{p.triangle[0], 0, 0};
  if (p.is_pair() && (by_area || p.is_rectangle)) {
    Vec2 at = u;
    if (!by_area) {
      const TriangleCorners c = corners(p.triangle[0]);
      const Vec3 &apex = c[p.apex[0]], &x = c[(p.apex[0] + 1) % 3], &y = c[(p.apex[0] + 2) % 3];
      at = sample_spherical_rectangle(reference, apex, x - apex, y - apex, u);
    }
    chosen = parallelogram_point(p, at);
  } else if (by_area) {
    const Vec2 b = sample_triangle_area(u);
    chosen = {p.triangle[0], b.x, b.y};
  } else {
    // One of the triangles in proportion to its solid angle: uniform over both.
    const double split = seen.solid_angle[0] / seen.total();
    const int which = p.is_pair() && u.x >= split;
    const double rescaled = which ? (u.x - split) / (1 - split) : u.x / split;
    const Vec2 rest{float(std::clamp(rescaled, 0.0, 1.0)), u.y};
    const Vec2 b =
        sample_spherical_triangle(reference, corners(p.triangle[which]), seen.solid_angle[which], rest);
    chosen = {p.triangle[which], b.x, b.y};
  }
  const MeshPoint at = point_at(chosen.triangle, chosen.b1, chosen.b2);
  const float pdf = by_area ? area_sampling_pdf(reference, at.p, at.ng, p.area) : float(1 / seen.total());
  if (!(pdf > 0) || !std::isfinite(pdf)) return std::nullopt;
  return ShapeSample{at.p, at.p_error, at.ng, at.uv, pdf, chosen.triangle, {chosen.b1, chosen.b2}};
}

std::optional<ShapeSample> Mesh::sample_area(std::size_t index, Vec2 u) const {
  const MeshPatch p = patch(index);
  TriangleSample chosen{p.triangle[0], 0, 0};
  if (p.is_pair()) {
    chosen = parallelogram_point(p, u);
  } else {
    const Vec2 b = sample_triangle_area(u);
    chosen.b1 = b.x, chosen.b2 = b.y;
  }
  if (!(p.area > 0)) return std::nullopt;
  const MeshPoint at = point_at(chosen.triangle, chosen.b1, chosen.b2);
  return ShapeSample{at.p, at.p_error, at.ng, at.uv, 1 / p.area, chosen.triangle, {chosen.b1, chosen.b2}};
}

float Mesh::pdf_direct(const Vec3& reference, std::size_t index, const SurfacePoint& point) const {
  const MeshPatch p = patch(index);
  const PatchView seen = view(reference, p);
  if (seen.technique == PatchView::Technique::none) return 0;
  if (seen.technique == PatchView::Technique::solid_angle) return float(1 / seen.total());
  const float pdf = area_sampling_pdf(reference, point.p, point.ng, p.area);
  return std::isfinite(pdf) ? pdf : 0;
}

}  // namespace aureole
