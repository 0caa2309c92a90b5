// SPDX-License-Identifier: Apache-2.0
#include "aureole/plugin/registry.h"
#include "aureole/shape/mesh/mesh.h"

namespace aureole {
namespace {

class Rectangle final : public Mesh {
public:
  explicit Rectangle(const Properties& properties) : Mesh(properties) {
    MeshData d;
    for (int i = 0; i < 4; ++i) {
      const int x = i & 1, y = i >> 1;
      d.positions.push_back(place_point(2 * x - 1, 2 * y - 1, 0));
      d.normals.push_back(place_normal(0, 0, 1));
      d.uvs.push_back({float(x), float(y)});
    }
    d.triangles = {{1, 2, 0}, {1, 3, 2}};
    build(std::move(d), "to_world");
  }
};

AUREOLE_PLUGIN(
    Rectangle, "shape", "rectangle",
    PluginDoc{
        .summary =
            "The square [-1, 1] x [-1, 1] in the plane z = 0, normal +z, texture coordinates from (0, 0) at "
            "(-1, -1) to (1, 1) at (1, 1). As an emitter it is sampled uniformly in solid angle.",
        .source = "Sampling: Urena, Fajardo & King 2013, \"An area-preserving parametrization for spherical "
                  "rectangles\".",
        .parameters = mesh_parameters({}),
        .examples = {R"(<shape type="rectangle">
  <transform name="to_world">
    <scale x="2" y="0.5"/>
    <translate z="1"/>
  </transform>
  <boolean name="face_normals" value="false"/>
  <boolean name="flip_normals" value="true"/>
  <bsdf type="diffuse"/>
  <emitter type="area"><float name="radiance" value="1"/></emitter>
</shape>)"}});

}  // namespace
}  // namespace aureole
