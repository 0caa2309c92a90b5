// SPDX-License-Identifier: Apache-2.0
// Bump mapping: the shading frame of the surface displaced by a texture h(u, v),
//     dp/du' = dp/du + n dh/du,  dp/dv' = dp/dv + n dh/dv,
// without the small terms that contain derivatives of n (Blinn 1978, "Simulation of wrinkled surfaces").
#include "aureole/bsdf/nested/perturbed_frame.h"
#include "aureole/plugin/registry.h"
#include "aureole/shape/shape.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

class BumpMap final : public PerturbedFrame {
public:
  explicit BumpMap(const Properties& properties)
      : PerturbedFrame(properties), scale_(float(properties.get_float("scale", 1))) {
    const auto textures = properties.get_children<Texture>("texture");
    if (textures.size() != 1)
      throw Error(properties.where(),
                  "\"bumpmap\" needs one nested texture, got " + std::to_string(textures.size()));
    height_ = textures.front();
    if (!height_->has_gradient())
      throw Error(height_->properties().where(), "the texture \"" + height_->properties().type() +
                                                     "\" has no gradient, which \"bumpmap\" needs; use a "
                                                     "\"bitmap\"");
  }

protected:
  Vec3 perturbed_normal(const SurfacePoint& point) const override {
    const Vec2 slope = height_->gradient(point) * scale_;
    if (slope.x == 0 && slope.y == 0) return {0, 0, 1};
    const auto [dp_du, dp_dv] = point.shape->derivatives(point);
    const Frame& f = point.shading;
    const Vec3 n =
        cross({dot(f.s, dp_du), dot(f.t, dp_du), slope.x}, {dot(f.s, dp_dv), dot(f.t, dp_dv), slope.y});
    // The normal is kept on its side, since texture coordinates may be left-handed or constant.
    return n.z > 0 ? n : n.z < 0 ? -n : Vec3{0, 0, 1};
  }

private:
  TexturePtr height_;
  float scale_;
};

AUREOLE_PLUGIN(
    BumpMap, "bsdf", "bumpmap",
    PluginDoc{
        "Gives a BSDF the shading of a surface displaced by a texture: dents, scratches, waves. The texture "
        "is a height in scene units along the normal; only its gradient matters, so a `bitmap` needs the "
        "`filter_type` bilinear, and `raw` true if its values are heights and not colours.",
        "J. F. Blinn, Simulation of wrinkled surfaces, SIGGRAPH 1978",
        perturbed_frame_parameters(
            {{"texture", "texture", "scene units", "required", "the height, under any name"},
             {"scale", "float", "", "1", "factor of the height; negative turns hills into dents"}}),
        {R"(<bsdf type="bumpmap">
    <texture type="bitmap">
        <string name="filename" value="heights.png"/>
        <boolean name="raw" value="true"/>
    </texture>
    <float name="scale" value="0.5"/>
    <bsdf type="plastic"/>
</bsdf>)",
         R"(<bsdf type="bumpmap">
    <texture type="bitmap">
        <string name="filename" value="heights.png"/>
        <boolean name="raw" value="true"/>
    </texture>
    <boolean name="flip_invalid_normals" value="false"/>
    <boolean name="use_shadowing_function" value="false"/>
    <bsdf type="diffuse"/>
</bsdf>)"}});

}  // namespace
}  // namespace aureole
