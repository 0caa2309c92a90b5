// SPDX-License-Identifier: Apache-2.0
// What Mesh has for its data as a whole: attributes, and parts of it.
#include "aureole/shape/mesh_parts.h"

#include <algorithm>

#include "aureole/texture/texture.h"

namespace aureole {

bool Mesh::wants_attribute(std::string_view name) const {
  const auto textures = attribute_textures(properties());
  return std::any_of(textures.begin(), textures.end(),
                     [&](const AttributeTexture* t) { return t->attribute_name() == name; });
}

void Mesh::bind_attributes(std::string_view source) {
  for (const AttributeTexture* texture : attribute_textures(properties())) {
    const auto& all = data_.attributes;
    const auto found = std::find_if(all.begin(), all.end(), [&](const MeshAttribute& a) {
      return a.name() == texture->attribute_name();
    });
    if (found == all.end()) {
      std::string names;
      for (const std::string& name : data_.attribute_names) names += (names.empty() ? "" : ", ") + name;
      throw properties().error(source, "the mesh has no attribute \"" + texture->attribute_name() + "\"" +
                                           (names.empty() ? ", nor any other" : "; it has: " + names));
    }
    float minimum, maximum;
    SampledSpectrum mean;
    found->summarize(properties().context().grid, minimum, maximum, mean);
    texture->attach(minimum, maximum, mean);
    shown_.emplace_back(texture, std::size_t(found - all.begin()));
  }
}

Spectrum Mesh::attribute(const Texture& texture, const SurfacePoint& point, const Wavelengths& w) const {
  for (const auto& [user, index] : shown_) {
    if (user != &texture) continue;
    const MeshAttribute& a = data_.attributes[index];
    constexpr float kOne = 1;
    if (a.of_faces()) return a.eval(&point.primitive, &kOne, 1, w);
    const Vec2 b = point.barycentric;
    const float weights[3] = {1 - b.x - b.y, b.x, b.y};
    return a.eval(data_.triangles[point.primitive].data(), weights, 3, w);
  }
  return 0.f;
}

void Mesh::adopt(MeshData data) {
  data_ = std::move(data);
  find_bounds();
  data_.positions.push_back({});  // see build()
  find_planes();
}

MeshData Mesh::release() {
  data_.positions.pop_back();
  planes_ = {};
  return std::move(data_);
}

namespace {

class MeshPart final : public Mesh {
public:
  MeshPart(const Properties& properties, BsdfPtr bsdf, MeshData data, std::vector<std::string> remarks)
      : Mesh(properties, std::move(bsdf)) {
    remarks_ = std::move(remarks);
    adopt(std::move(data));
  }
};

/// Copies values that a part of the triangles uses and counts them anew.
class Compactor {
public:
  /// `used` must be at least as long as any list of values.
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
                                 std::span<const BsdfPtr> bsdfs, std::vector<std::string> remarks) {
  std::vector<BsdfPtr> kinds;
  std::vector<std::size_t> kind_of(bsdfs.size());
  for (std::size_t i = 0; i < bsdfs.size(); ++i) {
    const auto known = std::find(kinds.begin(), kinds.end(), bsdfs[i]);
    kind_of[i] = std::size_t(known - kinds.begin());
    if (known == kinds.end()) kinds.push_back(bsdfs[i]);
  }
  std::vector<std::vector<std::uint32_t>> triangles(kinds.size());
  for (std::uint32_t i = 0; i < data.triangles.size(); ++i)
    triangles[kind_of[data.materials[i]]].push_back(i);

  Compactor compactor(std::max({data.positions.size(), data.normals.size(), data.uvs.size()}));
  std::vector<ShapePtr> parts;
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    const std::vector<std::uint32_t>& part = triangles[k];
    if (part.empty()) continue;
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
    // In the same order as the positions.
    if (normals_by_position) d.normal_triangles = {};
    if (uvs_by_position) d.uv_triangles = {};
    d.positions.reserve(d.positions.size() + 1);
    parts.push_back(std::make_shared<MeshPart>(properties, kinds[k], std::move(d), std::move(remarks)));
    remarks = {};
  }
  return parts;
}

}  // namespace aureole
