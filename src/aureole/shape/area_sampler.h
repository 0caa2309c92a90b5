// SPDX-License-Identifier: Apache-2.0
// Points on the surface of a shape, for the lights and sensors that sit on it. Made on demand by
// `Shape::make_area_sampler`, so that other shapes pay nothing for it.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include "aureole/shape/surface_point.h"

namespace aureole {

/// A point of a shape chosen by `sample_direct` or `sample_area`.
struct ShapeSample {
  Vec3 p, p_error, ng;
  Vec2 uv;
  float pdf;  ///< of sample_direct: solid-angle density seen from the reference point [1/sr]
  std::uint32_t primitive = 0;
  Vec2 barycentric{};
};

/// The part of a sample that a light of uniform radiance needs: no texture coordinates.
struct PositionSample {
  Vec3 p, p_error, ng;
  float pdf = 0;  ///< 0: there is no such point
};

/// The use of the sampler. For emitters triangles of a mesh are paired into patches; sensors, which only
/// sample uniformly over the whole surface, take every triangle as a patch.
enum class AreaUse { emitter, sensor };

/// A surface is divided into patches that are sampled one by one: a triangle, a parallelogram of two
/// triangles, a sphere, a disc. The shape must outlive its sampler.
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
  /// Mean normal and the cosine of the half-angle of the cone that holds all normals of the patch.
  virtual std::pair<Vec3, float> patch_normals(std::size_t patch) const = 0;

  /// A point of the patch as seen from `reference`, by solid angle where that pays; nothing where the patch
  /// can't be seen or has no area.
  virtual std::optional<ShapeSample> sample_direct(const Vec3& reference, std::size_t patch,
                                                   Vec2 u) const = 0;
  /// The same point and density.
  virtual PositionSample sample_direct_position(const Vec3& reference, std::size_t patch, Vec2 u) const {
    const auto s = sample_direct(reference, patch, u);
    return s ? PositionSample{s->p, s->p_error, s->ng, s->pdf} : PositionSample{};
  }
  /// A point of the patch, uniform or nearly so; `pdf` is per area [1/m^2]. Nothing where it has no area.
  virtual std::optional<ShapeSample> sample_area(std::size_t patch, Vec2 u) const = 0;
  /// Density of sample_area at a point of the patch [1/m^2]; 0 where it has no area.
  virtual float pdf_area(std::size_t patch, const SurfacePoint& /*point*/) const {
    const float area = patch_area(patch);
    return area > 0 ? 1 / area : 0;
  }
  /// Solid-angle density with which sample_direct chooses the point `point` of the patch from `reference`.
  virtual float pdf_direct(const Vec3& reference, std::size_t patch, const SurfacePoint& point) const = 0;

  /// The point with these texture coordinates in [0, 1]^2, one of them where there are several, nothing where there
  /// is none. Its `pdf` is not set.
  virtual std::optional<ShapeSample> point_at_uv(Vec2 /*uv*/) const { return {}; }

  virtual std::size_t memory_bytes() const { return sizeof *this; }

  /// Of all patches.
  double area() const {
    double sum = 0;
    for (std::size_t i = 0; i < patch_count(); ++i) sum += patch_area(i);
    return sum;
  }
};

}  // namespace aureole
