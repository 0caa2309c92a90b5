// SPDX-License-Identifier: Apache-2.0
// Triangle meshes: what every mesh reader builds.
//
// Conventions, the same as Mitsuba 3's:
// - Everything is placed in the world at load. Vertex normals are transformed by the inverse transpose of
//   `to_world`. If it mirrors, the order of the vertices is reversed, so that a closed surface keeps its normals
//   outside. `flip_normals` reverses the order (vertices 0 and 2 swap) and negates the vertex normals.
// - The geometric normal is cross(p1 - p0, p2 - p0), normalised. Where the file gives vertex normals, they
//   decide which side is out (and which side of an area emitter shines): a triangle wound against the sum of
//   its vertex normals is reversed at load.
// - Without vertex normals in the file, they are computed, weighted by the angle at each corner (Thürmer &
//   Wüthrich 1998, "Computing vertex normals from polygonal facets"), and shared by all triangles at a position;
//   `face_normals` drops normals.
// - Without texture coordinates uv are the barycentric coordinates (b1, b2).
#pragma once

#include <array>
#include <cstdint>

#include "aureole/plugin/registry.h"
#include "aureole/shape/mesh/mesh_attribute.h"
#include "aureole/shape/mesh/mesh_patches.h"
#include "aureole/shape/shape.h"

namespace aureole {

/// The data that a reader passes to Mesh, in world coordinates. Attribute indices are apart from position
/// indices, so that a texture seam is not a crack; where they are empty, the position indices are used. A
/// zero normal means "none here".
struct MeshData {
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;  ///< empty: none in the file
  std::vector<Vec2> uvs;      ///< empty: none in the file
  std::vector<TriangleIndices> triangles, normal_triangles, uv_triangles;
  std::vector<MeshAttribute> attributes;     ///< those that textures show
  std::vector<std::string> attribute_names;  ///< all in the file, for messages
  std::vector<std::uint32_t> materials;      ///< of each triangle; empty: one for all
};

/// Derived from a triangle's corners: the geometric normal, and a bound of the distance along it of an
/// interpolated point from the plane. It has two parts: the interpolation's own rounding (Pharr, Jakob &
/// Humphreys 2023, section 6.8.4), which is largest at a corner; and the distance at which the float ray
/// caster may still see a hit at t > 0: it finds t from dot(p0 - o, n) / dot(d, n), whose numerator errs by
/// some half ulps of |p0 - o|, and by as many of |p0 - o| |e| |e| / |n| from n itself, which counts for
/// slender triangles. Without it a ray that leaves a point near the coordinate origin on a triangle with a
/// far corner meets that triangle again.
struct TrianglePlane {
  Vec3 ng;
  float error;
};

/// A point of a triangle without its shading frame.
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

  /// The geometry as it is rendered; edges and neighbours are found from the position indices.
  const MeshData& data() const { return data_; }

protected:
  /// Reads to_world, flip_normals and face_normals.
  explicit Mesh(const Properties& properties);

  /// A part of another mesh, of data that was built before.
  Mesh(const Properties& properties, PartOfShape, MeshData data);

  /// Whether a texture reads this attribute; others are not kept.
  bool wants_attribute(std::string_view name) const;

  /// A position of the file in the world: computed in double, rounded once.
  Vec3 place_point(double x, double y, double z) const;
  /// A normal of the file in the world, of unit length, or zero where it has no direction.
  Vec3 place_normal(double x, double y, double z) const;
  bool face_normals() const { return face_normals_; }

  /// Takes the data over: drops degenerate triangles, orients, computes normals. `source` is the parameter
  /// that errors point to. Every index must be in range.
  void build(MeshData data, std::string_view source);

private:
  friend class MeshSampler;
  std::size_t drop_degenerate();
  void find_bounds();
  void reverse(std::size_t triangle);
  void orient_by_vertex_normals();
  void compute_vertex_normals();
  const TriangleIndices& normal_triangle(std::size_t i) const {
    return data_.normal_triangles.empty() ? data_.triangles[i] : data_.normal_triangles[i];
  }
  const TriangleIndices& uv_triangle(std::size_t i) const {
    return data_.uv_triangles.empty() ? data_.triangles[i] : data_.uv_triangles[i];
  }
  TriangleCorners corners(std::size_t triangle) const;
  Vec2 interpolate_uv(std::uint32_t triangle, float b0, float b1, float b2) const;
  MeshPoint point_at(std::uint32_t triangle, float b1, float b2) const;
  Vec3 tangent(std::uint32_t primitive) const;  ///< along dp/du; zero where texture coordinates are constant
  Transform to_world_;
  bool identity_ = true, reverse_winding_ = false, flip_normals_ = false, face_normals_ = false;
  void find_planes();

  MeshData data_;
  std::vector<TrianglePlane> planes_;
  Bounds3 bounds_;
  std::string source_;  ///< the parameter that errors point to
};

/// `own` followed by the rows of the parameter table that meshes share: face_normals.
std::vector<ParameterDoc> mesh_parameters(std::vector<ParameterDoc> own);

}  // namespace aureole
