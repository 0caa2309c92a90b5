// SPDX-License-Identifier: Apache-2.0
#include "aureole/plugin/registry.h"
#include "aureole/shape/mesh/mesh.h"

namespace aureole {
namespace {

class Cube final : public Mesh {
public:
  explicit Cube(const Properties& properties) : Mesh(properties) {
    MeshData d;
    for (int i = 0; i < 8; ++i)
      d.positions.push_back(place_point(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
    d.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    // Corners of a side, counter-clockwise as seen from outside. Bit k of a corner is the sign of axis k.
    struct Side {
      int normal[3];
      std::uint32_t corner[4];
    };
    static constexpr Side kSides[6] = {{{0, -1, 0}, {1, 5, 4, 0}}, {{0, 1, 0}, {3, 2, 6, 7}},
                                       {{1, 0, 0}, {1, 3, 7, 5}},  {{0, 0, 1}, {5, 7, 6, 4}},
                                       {{-1, 0, 0}, {4, 6, 2, 0}}, {{0, 0, -1}, {3, 1, 0, 2}}};
    for (std::uint32_t s = 0; s < 6; ++s) {
      const auto& [n, c] = kSides[s];
      d.normals.push_back(place_normal(n[0], n[1], n[2]));
      for (const TriangleIndices& t : {TriangleIndices{0, 1, 2}, TriangleIndices{3, 0, 2}}) {
        d.triangles.push_back({c[t[0]], c[t[1]], c[t[2]]});
        d.normal_triangles.push_back({s, s, s});
        d.uv_triangles.push_back(t);
      }
    }
    build(std::move(d), "to_world");
  }
};

AUREOLE_PLUGIN(
    Cube, "shape", "cube",
    PluginDoc{
        .summary = "The cube [-1, 1]^3 with outward normals. Every side has texture coordinates over [0, "
                   "1]^2.",
        .source = "",
        .parameters = mesh_parameters({}),
        .examples = {R"(<shape type="cube">
  <transform name="to_world"><scale value="0.5"/></transform>
  <boolean name="face_normals" value="false"/>
  <boolean name="flip_normals" value="false"/>
  <bsdf type="diffuse"/>
  <emitter type="area"><float name="radiance" value="1"/></emitter>
</shape>)"}});

}  // namespace
}  // namespace aureole
