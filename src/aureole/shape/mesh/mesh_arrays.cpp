// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "aureole/plugin/array.h"
#include "aureole/plugin/registry.h"
#include "aureole/shape/mesh/mesh.h"

namespace aureole {
namespace {

/// Reads an array of n x `columns` finite numbers; null if absent.
std::shared_ptr<const Array> rows(const Properties& p, const char* name, std::size_t columns) {
  const auto array = p.get_object<Array>(name);
  if (!array) return nullptr;
  if (array->shape().size() != 2 || array->shape()[1] != columns)
    throw p.error(name, "expected an array of n x " + std::to_string(columns) + " numbers");
  for (const double v : array->values())
    if (!std::isfinite(v)) throw p.error(name, "expected finite numbers");
  if (array->shape()[0] >= std::size_t(1) << 32) throw p.error(name, "too many rows");
  return array;
}

class MeshOfArrays final : public Mesh {
public:
  explicit MeshOfArrays(const Properties& p) : Mesh(p) {
    const auto vertices = rows(p, "vertices", 3), faces = rows(p, "faces", 3),
               normals = rows(p, "normals", 3), uvs = rows(p, "uvs", 2);
    if (!vertices || !faces)
      throw p.error(
          vertices ? "faces" : "vertices",
          std::string("needs the arrays vertices and faces, which a program gives: in a scene file a "
                      "mesh is a ply, obj or serialized shape"));
    const std::size_t count = vertices->shape()[0];
    for (const auto& [name, array] : {std::pair{"normals", normals}, std::pair{"uvs", uvs}})
      if (array && array->shape()[0] != count)
        throw p.error(name, "expected one row for each of the " + std::to_string(count) + " vertices, got " +
                                std::to_string(array->shape()[0]));
    MeshData d;
    const double* v = vertices->values().data();
    d.positions.reserve(count);
    for (std::size_t i = 0; i < count; ++i)
      d.positions.push_back(place_point(v[3 * i], v[3 * i + 1], v[3 * i + 2]));
    if (normals) {
      const double* n = normals->values().data();
      for (std::size_t i = 0; i < count; ++i)
        d.normals.push_back(place_normal(n[3 * i], n[3 * i + 1], n[3 * i + 2]));
    }
    if (uvs) {
      const double* t = uvs->values().data();
      for (std::size_t i = 0; i < count; ++i) d.uvs.push_back({float(t[2 * i]), float(t[2 * i + 1])});
    }
    const double* f = faces->values().data();
    for (std::size_t i = 0; i < faces->shape()[0]; ++i) {
      TriangleIndices t;
      for (std::size_t k = 0; k < 3; ++k) {
        const double index = f[3 * i + k];
        if (!(index >= 0 && index < double(count)) || index != std::floor(index))
          throw p.error("faces", "row " + std::to_string(i) + " refers to vertex " + std::to_string(index) +
                                     "; expected integers from 0 to " + std::to_string(count) + " - 1");
        t[k] = std::uint32_t(index);
      }
      d.triangles.push_back(t);
    }
    build(std::move(d), "faces");
  }
};

AUREOLE_PLUGIN(
    MeshOfArrays, "shape", "mesh",
    PluginDoc{
        .summary = "A triangle mesh from arrays, for scenes made by a program (Python's load_dict). Without "
                   "normals, they are computed from positions, weighted by angle.",
        .source = "Normals: Thuermer & Wuethrich 1998, \"Computing vertex normals from polygonal facets\".",
        .parameters =
            mesh_parameters({{"vertices", "array", "", "required", "n x 3: positions"},
                             {"faces", "array", "", "required", "m x 3: indices of vertices, from 0"},
                             {"normals", "array", "", "none", "n x 3: normals at the vertices"},
                             {"uvs", "array", "", "none", "n x 2: texture coordinates at the vertices"}}),
        .examples = {}});

}  // namespace
}  // namespace aureole
