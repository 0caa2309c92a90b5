// SPDX-License-Identifier: Apache-2.0
// Sampling of a mesh's patches from a reference point.
#include <limits>
#include <mutex>

#include "aureole/shape/geometry/double3.h"
#include "aureole/shape/mesh/mesh.h"
#include "aureole/shape/mesh/uv_index.h"
#include "aureole/shape/sampling/spherical_sampling.h"

namespace aureole {

namespace {

/// Samples coordinates (x, y) uniformly over the area of a triangle.
Vec2 sample_triangle_area(Vec2 u) {
  const float s = std::sqrt(u.x);
  return {u.y * s, (1 - u.y) * s};
}

/// A point on a triangle by its barycentrics of vertices 1 and 2.
struct TrianglePoint {
  std::uint32_t triangle;
  Vec2 barycentric;
};

/// Returns the triangle of the patch that contains the coordinates `at`, and the point in it.
TrianglePoint triangle_point(const MeshPatch& patch, Vec2 at) {
  float b[3];
  const bool far = patch.is_pair() && at.x + at.y > 1;
  const int k = patch.apex[far];
  if (far)  // the second triangle traverses the shared edge in the opposite direction
    b[(k + 1) % 3] = 1 - at.x, b[(k + 2) % 3] = 1 - at.y, b[k] = at.x + at.y - 1;
  else
    b[(k + 1) % 3] = at.x, b[(k + 2) % 3] = at.y, b[k] = 1 - at.x - at.y;
  return {patch.triangle[far], {b[1], b[2]}};
}

/// Returns the patch coordinates of a point with these barycentrics in one of the patch's triangles.
Vec2 place_of(const MeshPatch& patch, int which, Vec2 barycentric) {
  const float b[3] = {1 - barycentric.x - barycentric.y, barycentric.x, barycentric.y};
  const int k = patch.apex[which];
  const Vec2 at{b[(k + 1) % 3], b[(k + 2) % 3]};
  return which ? Vec2{1 - at.x, 1 - at.y} : at;
}

}  // namespace

class MeshSampler final : public AreaSampler {
public:
  MeshSampler(const Mesh& mesh, AreaUse use);

  std::size_t patch_count() const override {
    return patches_.empty() ? mesh_.primitive_count() : patches_.patches.size();
  }
  std::size_t patch_of_primitive(std::uint32_t primitive) const override {
    return patches_.empty() ? primitive : patches_.of_triangle[primitive];
  }
  float patch_area(std::size_t patch) const override;
  Bounds3 patch_bounds(std::size_t patch) const override;
  std::pair<Vec3, float> patch_normals(std::size_t patch) const override;
  std::optional<ShapeSample> sample_direct(const Vec3& reference, std::size_t patch, Vec2 u) const override;
  PositionSample sample_direct_position(const Vec3& reference, std::size_t patch, Vec2 u) const override;
  std::optional<ShapeSample> sample_area(std::size_t patch, Vec2 u) const override;
  float pdf_direct(const Vec3& reference, std::size_t patch, const SurfacePoint& point) const override;
  std::optional<ShapeSample> point_at_uv(Vec2 uv) const override;
  std::size_t memory_bytes() const override {
    return sizeof *this + patches_.patches.capacity() * sizeof(MeshPatch) +
           patches_.of_triangle.capacity() * sizeof(std::uint32_t);
  }

private:
  void add_plane_error(MeshPatch& patch) const;
  /// Returns the patch; `made` stores it if there is no table of patches.
  const MeshPatch& patch(std::size_t index, MeshPatch& made) const;
  PatchView view(const Vec3& reference, const MeshPatch& patch) const;
  /// A point of a patch, sampled from a reference point; pdf is 0 if there is none.
  struct PatchSample {
    Vec2 at;
    Vec3 p;
    float pdf = 0;
  };
  PatchSample sample_visible(const Vec3& reference, const MeshPatch& patch, Vec2 u) const;
  ShapeSample shape_sample(const MeshPatch& patch, Vec2 at, const Vec3& p, float pdf) const;

  const Mesh& mesh_;
  MeshPatches patches_;  ///< patches of the mesh; empty if every triangle is a patch
  mutable std::once_flag uv_once_;
  mutable std::optional<UvIndex> uv_index_;  ///< index for lookups by texture coordinates, made on demand
};

std::shared_ptr<const AreaSampler> Mesh::make_area_sampler(AreaUse use) const {
  if (use == AreaUse::emitter && data_.triangles.empty())
    throw properties().error(source_, "an emitter needs at least one triangle of non-zero area");
  return std::make_shared<const MeshSampler>(*this, use);
}

MeshSampler::MeshSampler(const Mesh& mesh, AreaUse use) : mesh_(mesh) {
  if (use != AreaUse::emitter) return;
  // The last position is left out, since it only keeps reads in range (see Mesh::build).
  const std::span<const Vec3> positions(mesh.data_.positions);
  patches_ = MeshPatches::build(positions.first(positions.size() - 1), mesh.data_.triangles);
  for (MeshPatch& patch : patches_.patches) add_plane_error(patch);
}

const MeshPatch& MeshSampler::patch(std::size_t index, MeshPatch& made) const {
  if (!patches_.empty()) return patches_.patches[index];
  made.triangle[0] = std::uint32_t(index);
  made.measure(mesh_.data_.positions, mesh_.data_.triangles);
  add_plane_error(made);
  return made;
}

void MeshSampler::add_plane_error(MeshPatch& patch) const {
  float error = mesh_.planes_[patch.triangle[0]].error;
  if (patch.is_pair()) error = std::max(error, mesh_.planes_[patch.triangle[1]].error);
  patch.error += error;
}

float MeshSampler::patch_area(std::size_t index) const {
  MeshPatch made;
  return patch(index, made).area;
}

Bounds3 MeshSampler::patch_bounds(std::size_t index) const {
  Bounds3 b;
  MeshPatch made;
  for (const std::uint32_t t : patch(index, made).triangle)
    if (t != MeshPatch::kNone)
      for (const Vec3& corner : mesh_.corners(t)) b.extend(corner);
  return b;
}

std::pair<Vec3, float> MeshSampler::patch_normals(std::size_t index) const {
  MeshPatch made;
  return {patch(index, made).ng, 1.f};
}

PatchView MeshSampler::view(const Vec3& reference, const MeshPatch& p) const {
  if (PatchView::is_far(reference, p)) return {PatchView::Technique::area, {}};
  if (!p.is_pair()) return PatchView::of(reference, mesh_.corners(p.triangle[0]), nullptr);
  const TriangleCorners second = mesh_.corners(p.triangle[1]);
  return PatchView::of(reference, mesh_.corners(p.triangle[0]), &second);
}

MeshSampler::PatchSample MeshSampler::sample_visible(const Vec3& reference, const MeshPatch& p,
                                                     Vec2 u) const {
  PatchSample s;
  const PatchView seen = view(reference, p);
  if (seen.technique == PatchView::Technique::none) return s;
  if (seen.technique == PatchView::Technique::area) {
    s.at = p.is_pair() ? u : sample_triangle_area(u);
    s.p = p.point(s.at);
    s.pdf = area_sampling_pdf(reference, s.p, p.ng, p.area);
  } else {
    if (p.is_rectangle) {
      s.at = sample_spherical_rectangle(reference, p.origin, p.along_x, p.along_y, u);
    } else {
      // Choosing a triangle in proportion to its solid angle makes the density uniform over both.
      const double split = seen.solid_angle[0] / seen.total();
      const int which = p.is_pair() && u.x >= split;
      const double rescaled = which ? (u.x - split) / (1 - split) : u.x / split;
      const Vec2 rest{float(std::clamp(rescaled, 0.0, 1.0)), u.y};
      s.at = place_of(p, which,
                      sample_spherical_triangle(reference, mesh_.corners(p.triangle[which]),
                                                seen.solid_angle[which], rest));
    }
    s.p = p.point(s.at);
    s.pdf = float(1 / seen.total());
  }
  if (!(s.pdf <= std::numeric_limits<float>::max())) s.pdf = 0;
  return s;
}

PositionSample MeshSampler::sample_direct_position(const Vec3& reference, std::size_t index, Vec2 u) const {
  MeshPatch made;
  const MeshPatch& p = patch(index, made);
  const PatchSample s = sample_visible(reference, p, u);
  return {s.p, abs(p.ng) * p.error, p.ng, s.pdf};
}

ShapeSample MeshSampler::shape_sample(const MeshPatch& patch, Vec2 at, const Vec3& p, float pdf) const {
  const auto [triangle, b] = triangle_point(patch, at);
  return {p,        abs(patch.ng) * patch.error,
          patch.ng, mesh_.interpolate_uv(triangle, 1 - b.x - b.y, b.x, b.y),
          pdf,      triangle,
          b};
}

std::optional<ShapeSample> MeshSampler::sample_direct(const Vec3& reference, std::size_t index,
                                                      Vec2 u) const {
  MeshPatch made;
  const MeshPatch& p = patch(index, made);
  const PatchSample s = sample_visible(reference, p, u);
  if (!(s.pdf > 0)) return std::nullopt;
  return shape_sample(p, s.at, s.p, s.pdf);
}

std::optional<ShapeSample> MeshSampler::sample_area(std::size_t index, Vec2 u) const {
  MeshPatch made;
  const MeshPatch& p = patch(index, made);
  if (!(p.area > 0)) return std::nullopt;
  const Vec2 at = p.is_pair() ? u : sample_triangle_area(u);
  return shape_sample(p, at, p.point(at), 1 / p.area);
}

std::optional<ShapeSample> MeshSampler::point_at_uv(Vec2 uv) const {
  if (mesh_.data_.uvs.empty()) return {};
  std::call_once(uv_once_, [&] {
    std::vector<UvIndex::Triangle> triangles;
    for (std::size_t i = 0; i < mesh_.primitive_count(); ++i) {
      const TriangleIndices& t = mesh_.uv_triangle(i);
      triangles.push_back({mesh_.data_.uvs[t[0]], mesh_.data_.uvs[t[1]], mesh_.data_.uvs[t[2]]});
    }
    uv_index_.emplace(std::move(triangles));
  });
  const auto at = uv_index_->find(uv);
  if (!at) return {};
  const MeshPoint point = mesh_.point_at(at->triangle, at->barycentric.x, at->barycentric.y);
  const auto corners = mesh_.corners(at->triangle);
  const TriangleIndices& t = mesh_.uv_triangle(at->triangle);
  const std::vector<Vec2>& uvs = mesh_.data_.uvs;
  const Vec2 a = uvs[t[1]] - uvs[t[0]], b = uvs[t[2]] - uvs[t[0]];
  const float pdf =
      std::abs(a.x * b.y - a.y * b.x) / length(cross(corners[1] - corners[0], corners[2] - corners[0]));
  return ShapeSample{point.p, point.p_error, point.ng, uv, pdf, at->triangle, at->barycentric};
}

float MeshSampler::pdf_direct(const Vec3& reference, std::size_t index, const SurfacePoint& point) const {
  MeshPatch made;
  const MeshPatch& p = patch(index, made);
  const PatchView seen = view(reference, p);
  if (seen.technique == PatchView::Technique::none) return 0;
  if (seen.technique == PatchView::Technique::solid_angle) return float(1 / seen.total());
  const float pdf = area_sampling_pdf(reference, point.p, point.ng, p.area);
  return std::isfinite(pdf) ? pdf : 0;
}

}  // namespace aureole
