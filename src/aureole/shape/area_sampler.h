// SPDX-License-Identifier: Apache-2.0
// Sampling of points on a shape's surface, for its emitter or sensor. Samplers are made on demand by
// `Shape::make_area_sampler`, so that shapes without emitter or sensor need no memory for them.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include "aureole/shape/surface_point.h"

namespace aureole {

/// A point on a shape, sampled by `sample_direct` or `sample_area`.
struct ShapeSample {
  Vec3 p, p_error, ng;
  Vec2 uv;
  /// solid-angle pdf from the reference point [1/sr] for sample_direct; pdf per area for sample_area
  float pdf;
  std::uint32_t primitive = 0;
  Vec2 barycentric{};
};

/// A sample without texture coordinates, sufficient for an emitter of uniform radiance.
struct PositionSample {
  Vec3 p, p_error, ng;
  float pdf = 0;  ///< solid-angle pdf [1/sr]; 0: no such point exists
};

/// Purpose of a sampler. For emitters, triangles of a mesh are paired into patches. Sensors sample the whole
/// surface uniformly, with every triangle as a patch.
enum class AreaUse { emitter, sensor };

/// Samples a surface that is divided into patches: a triangle, a parallelogram of two triangles, a sphere, a
/// disc. The shape must outlive its sampler.
class AreaSampler {
public:
  AreaSampler() = default;
  virtual ~AreaSampler() = default;
  AreaSampler(const AreaSampler&) = delete;
  AreaSampler& operator=(const AreaSampler&) = delete;

  virtual std::size_t patch_count() const { return 1; }
  virtual std::size_t patch_of_primitive(std::uint32_t) const { return 0; }
  virtual float patch_area(std::size_t patch) const = 0;
  virtual Bounds3 patch_bounds(std::size_t patch) const = 0;
  /// Returns the mean normal, and the cosine of the half-angle of the cone that contains all normals of the
  /// patch.
  virtual std::pair<Vec3, float> patch_normals(std::size_t patch) const = 0;

  /// Samples a point of the patch as seen from `reference`, by solid angle where that reduces noise enough
  /// for its cost. Empty if the patch is not visible from there or has no area.
  virtual std::optional<ShapeSample> sample_direct(const Vec3& reference, std::size_t patch,
                                                   Vec2 u) const = 0;
  /// Samples as `sample_direct` does: equal points and pdfs, but no texture coordinates.
  virtual PositionSample sample_direct_position(const Vec3& reference, std::size_t patch, Vec2 u) const {
    const auto s = sample_direct(reference, patch, u);
    return s ? PositionSample{s->p, s->p_error, s->ng, s->pdf} : PositionSample{};
  }
  /// Samples a point of the patch, uniformly or nearly so; `pdf` is per area [1/m^2]. Empty if the patch has
  /// no area.
  virtual std::optional<ShapeSample> sample_area(std::size_t patch, Vec2 u) const = 0;
  /// Returns the pdf of sample_area at a point of the patch [1/m^2]; 0 if the patch has no area.
  virtual float pdf_area(std::size_t patch, const SurfacePoint& /*point*/) const {
    const float area = patch_area(patch);
    return area > 0 ? 1 / area : 0;
  }
  /// Returns the solid-angle pdf with which sample_direct samples `point` of the patch from `reference`.
  virtual float pdf_direct(const Vec3& reference, std::size_t patch, const SurfacePoint& point) const = 0;

  /// Returns a point with these texture coordinates in [0, 1]^2, empty if there is none. Its `pdf` is that of points that are
  /// uniform over the texture coordinates, per area [1/m^2]: the inverse of |dp/du x dp/dv|, and infinite where that is 0.
  virtual std::optional<ShapeSample> point_at_uv(Vec2 /*uv*/) const { return {}; }

  virtual std::size_t memory_bytes() const { return sizeof *this; }

  /// Returns the area of all patches.
  double area() const {
    double sum = 0;
    for (std::size_t i = 0; i < patch_count(); ++i) sum += patch_area(i);
    return sum;
  }
};

}  // namespace aureole
