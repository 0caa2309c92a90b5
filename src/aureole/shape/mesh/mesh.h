// SPDX-License-Identifier: Apache-2.0
// Triangle meshes: the class that every mesh reader builds.
//
// Conventions, as in Mitsuba 3:
// - Everything is transformed to world space at load. Vertex normals are transformed by the inverse transpose
//   of `to_world`. If it mirrors, the vertex order is reversed, so that a closed surface keeps outward normals.
//   `flip_normals` reverses the order (vertices 0 and 2 swap) and negates the vertex normals.
// - The geometric normal is cross(p1 - p0, p2 - p0), normalised. Vertex normals of the file, if any, decide
//   which side is outside (and which side of an area emitter emits): a triangle wound against the sum of its
//   vertex normals is reversed at load.
// - Without vertex normals in the file they are computed, weighted by the angle at each corner (Thürmer &
//   Wüthrich 1998, "Computing vertex normals from polygonal facets"), and shared by all triangles at a
//   position; `face_normals` drops normals.
// - Without texture coordinates uv are the barycentric coordinates (b1, b2).
#pragma once

#include <array>
#include <cstdint>
#include <mutex>

#include "aureole/plugin/registry.h"
#include "aureole/shape/mesh/mesh_attribute.h"
#include "aureole/shape/mesh/mesh_patches.h"
#include "aureole/shape/shape.h"

namespace aureole {

/// The data that a reader passes to Mesh, in world space. Attribute indices are separate from position
/// indices, so that a texture seam is not a crack; if empty, the position indices are used. A zero normal
/// means that there is none.
struct MeshData {
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;  ///< vertex normals; empty: none in the file
  std::vector<Vec2> uvs;      ///< texture coordinates; empty: none in the file
  std::vector<TriangleIndices> triangles, normal_triangles, uv_triangles;
  std::vector<MeshAttribute> attributes;     ///< attributes that textures use
  std::vector<std::string> attribute_names;  ///< names of all attributes in the file, for messages
  std::vector<std::uint32_t> materials;      ///< material of each triangle; empty: one material for all
};

/// The geometric normal of a triangle, and an upper bound of the distance of an interpolated point from the
/// plane, along the normal. The bound has two parts. The first is the rounding of the interpolation (Pharr,
/// Jakob & Humphreys 2023, section 6.8.4), which is largest at a corner. The second is the distance at which
/// the ray caster, in float, may still report a hit at t > 0. It computes t from dot(p0 - o, n) / dot(d, n),
/// whose numerator errs by some half ulps of |p0 - o|. The error of n itself adds as many half ulps of |p0 -
/// o| |e| |e| / |n|, which matters for thin triangles. Without the second part, a ray that leaves a point
/// near the coordinate origin on a triangle with a distant corner hits that triangle again.
struct TrianglePlane {
  Vec3 ng;
  float error;
};

/// A point on a triangle, without its shading frame.
struct MeshPoint {
  Vec3 p, p_error, ng;
  Vec2 uv;
};

class Mesh : public Shape {
public:
  RTCGeometry make_geometry(RTCDevice device) const override;
  SurfacePoint surface_point(const ShapeHit& hit, const Ray& ray, bool tangent) const override;
  SurfaceDerivatives own_derivatives(const SurfacePoint& point) const override;
  Bounds3 bounds() const override { return bounds_; }
  std::size_t primitive_count() const override { return data_.triangles.size(); }
  std::size_t memory_bytes() const override;
  const MeshAttribute* attribute(const AttributeName& name) const override;
  Spectrum eval_attribute(const MeshAttribute& attribute, const SurfacePoint& point,
                          const Wavelengths& w) const override;
  Error no_attribute(const SourceLocation& where, const std::string& name) const override;
  std::shared_ptr<const AreaSampler> make_area_sampler(AreaUse use) const override;
  std::string opening() const override;

  /// The mesh as it is rendered; edges and neighbours are found from the position indices.
  const MeshData& data() const { return data_; }

protected:
  /// Reads to_world, flip_normals and face_normals.
  explicit Mesh(const Properties& properties);

  /// Makes a part of another mesh from data that has been built before.
  Mesh(const Properties& properties, PartOfShape, MeshData data);

  /// Whether a texture uses the attribute; other attributes are not stored.
  bool wants_attribute(std::string_view name) const;

  /// Returns a position of the file in world space: computed in double, rounded once.
  Vec3 place_point(double x, double y, double z) const;
  /// Returns a unit normal of the file in world space, or zero if it has no direction.
  Vec3 place_normal(double x, double y, double z) const;
  bool face_normals() const { return face_normals_; }

  /// Takes over the data: drops degenerate triangles, orients, computes normals. `source` is the parameter at
  /// which errors are located. Every index must be in range.
  void build(MeshData data, std::string_view source);

private:
  friend class MeshSampler;
  std::size_t drop_degenerate();
  void find_bounds();
  void reverse(std::size_t triangle);
  void orient_by_vertex_normals();
  void compute_vertex_normals();
  void compute_creased_normals();
  const TriangleIndices& normal_triangle(std::size_t i) const {
    return data_.normal_triangles.empty() ? data_.triangles[i] : data_.normal_triangles[i];
  }
  const TriangleIndices& uv_triangle(std::size_t i) const {
    return data_.uv_triangles.empty() ? data_.triangles[i] : data_.uv_triangles[i];
  }
  TriangleCorners corners(std::size_t triangle) const;
  Vec2 interpolate_uv(std::uint32_t triangle, float b0, float b1, float b2) const;
  MeshPoint point_at(std::uint32_t triangle, float b1, float b2) const;
  /// unit vector along dp/du; zero where texture coordinates are constant
  Vec3 tangent(std::uint32_t primitive) const;
  Transform to_world_;
  bool identity_ = true, reverse_winding_ = false, flip_normals_ = false, face_normals_ = false;
  /// largest angle between faces that share a smooth normal [degrees]; 0: vertex normals are used
  double max_smooth_angle_ = 0;
  void find_planes();

  MeshData data_;
  std::vector<TrianglePlane> planes_;
  Bounds3 bounds_;
  std::string source_;  ///< parameter at which errors are located
  mutable std::once_flag opening_is_known_;
  mutable std::string opening_;  ///< result of `opening`, computed on its first call
};

/// Returns `own` followed by the documentation of the parameter that meshes share: face_normals.
std::vector<ParameterDoc> mesh_parameters(std::vector<ParameterDoc> own);

}  // namespace aureole
