// SPDX-License-Identifier: Apache-2.0
// Functions of Mesh on its whole data: attributes, and the division into parts.
#include "aureole/shape/mesh/mesh_parts.h"

#include <algorithm>

namespace aureole {

bool Mesh::wants_attribute(std::string_view name) const {
  const auto& wanted = properties().shown_attributes();
  return std::find(wanted.begin(), wanted.end(), name) != wanted.end();
}

const MeshAttribute* Mesh::attribute(const AttributeName& name) const {
  for (const MeshAttribute& a : data_.attributes)
    if (a.name() == name) return &a;
  return nullptr;
}

Error Mesh::no_attribute(const SourceLocation&, const std::string& name) const {
  std::string names;
  for (const std::string& n : data_.attribute_names) names += (names.empty() ? "" : ", ") + n;
  return properties().error(source_, "the mesh has no attribute \"" + name + "\"" +
                                         (names.empty() ? ", nor any other" : "; it has: " + names));
}

Spectrum Mesh::eval_attribute(const MeshAttribute& a, const SurfacePoint& point, const Wavelengths& w) const {
  constexpr float kOne = 1;
  if (a.of_faces()) return a.eval(&point.primitive, &kOne, 1, w);
  const Vec2 b = point.barycentric;
  const float weights[3] = {1 - b.x - b.y, b.x, b.y};
  return a.eval(data_.triangles[point.primitive].data(), weights, 3, w);
}

Mesh::Mesh(const Properties& properties, PartOfShape part, MeshData data)
    : Shape(properties, part), data_(std::move(data)) {
  find_bounds();
  data_.positions.push_back({});  // padding for 16-byte reads; see build()
  find_planes();
}

namespace {

class MeshPart final : public Mesh {
public:
  MeshPart(const Properties& properties, MeshData data) : Mesh(properties, PartOfShape{}, std::move(data)) {}
};

/// Copies the values that a part of the triangles uses and renumbers them.
class Compactor {
public:
  /// Makes room for lists of at most `values` values.
  explicit Compactor(std::size_t values) : renamed_(values, kNone) {}

  template <class T>
  void copy(const std::vector<T>& from, const std::vector<TriangleIndices>& triangles,
            std::span<const std::uint32_t> part, std::vector<T>& to,
            std::vector<TriangleIndices>& to_triangles) {
    to_triangles.reserve(part.size());
    for (const std::uint32_t t : part) {
      TriangleIndices indices = triangles[t];
      for (std::uint32_t& i : indices) {
        if (renamed_[i] == kNone) renamed_[i] = std::uint32_t(to.size()), to.push_back(from[i]);
        i = renamed_[i];
      }
      to_triangles.push_back(indices);
    }
    for (const std::uint32_t t : part)
      for (const std::uint32_t i : triangles[t]) renamed_[i] = kNone;
  }

private:
  static constexpr std::uint32_t kNone = 0xffffffffu;
  std::vector<std::uint32_t> renamed_;
};

}  // namespace

std::vector<ShapePtr> split_mesh(const Properties& properties, const MeshData& data,
                                 std::span<const std::size_t> part_of) {
  std::vector<std::vector<std::uint32_t>> triangles;
  for (const std::size_t part : part_of) triangles.resize(std::max(triangles.size(), part + 1));
  for (std::uint32_t i = 0; i < data.triangles.size(); ++i)
    triangles[part_of[data.materials[i]]].push_back(i);

  Compactor compactor(std::max({data.positions.size(), data.normals.size(), data.uvs.size()}));
  std::vector<ShapePtr> parts;
  for (const std::vector<std::uint32_t>& part : triangles) {
    if (part.empty()) {
      parts.push_back(nullptr);
      continue;
    }
    MeshData d;
    compactor.copy(data.positions, data.triangles, part, d.positions, d.triangles);
    const bool normals_by_position = data.normal_triangles.empty(),
               uvs_by_position = data.uv_triangles.empty();
    if (!data.normals.empty())
      compactor.copy(data.normals, normals_by_position ? data.triangles : data.normal_triangles, part,
                     d.normals, d.normal_triangles);
    if (!data.uvs.empty())
      compactor.copy(data.uvs, uvs_by_position ? data.triangles : data.uv_triangles, part, d.uvs,
                     d.uv_triangles);
    // Values that are copied with the positions have their order and need no indices of their own.
    if (normals_by_position) d.normal_triangles = {};
    if (uvs_by_position) d.uv_triangles = {};
    d.positions.reserve(d.positions.size() + 1);
    parts.push_back(std::make_shared<const MeshPart>(properties, std::move(d)));
  }
  return parts;
}

}  // namespace aureole
