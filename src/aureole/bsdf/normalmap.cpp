// SPDX-License-Identifier: Apache-2.0
// Normal mapping: a picture stores the normal in the coordinates of the shading frame, as (n + 1) / 2.
#include "aureole/bsdf/nested/perturbed_frame.h"
#include "aureole/plugin/registry.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

class NormalMap final : public PerturbedFrame {
public:
  explicit NormalMap(const Properties& properties)
      : PerturbedFrame(properties), normals_(properties.get_object<Texture>("normalmap")) {
    if (!normals_)
      throw properties.error("normalmap", "\"normalmap\" needs a texture with the name \"normalmap\"");
    if (!normals_->has_rgb())
      throw properties.error("normalmap",
                             "needs a picture with three channels that hold no colours: a \"bitmap\" with "
                             "<boolean name=\"raw\" value=\"true\"/>");
  }

protected:
  Vec3 perturbed_normal(const SurfacePoint& point) const override {
    return normals_->eval_rgb(point) * 2 - Vec3{1, 1, 1};
  }

private:
  TexturePtr normals_;
};

AUREOLE_PLUGIN(
    NormalMap, "bsdf", "normalmap",
    PluginDoc{"Gives a BSDF the normals stored in a picture. Red, green and blue are the coordinates of the "
              "normal along dp/du, dp/dv and the normal of the surface, each as (n + 1) / 2: (0.5, 0.5, 1) "
              "changes nothing.",
              "",
              perturbed_frame_parameters({{"normalmap", "texture", "", "required",
                                           "a colour `bitmap` with `raw` true"}}),
              {R"(<bsdf type="normalmap">
    <texture name="normalmap" type="bitmap">
        <string name="filename" value="normals.png"/>
        <boolean name="raw" value="true"/>
    </texture>
    <bsdf type="plastic"/>
</bsdf>)",
               R"(<bsdf type="normalmap">
    <texture name="normalmap" type="bitmap">
        <string name="filename" value="normals.png"/>
        <boolean name="raw" value="true"/>
    </texture>
    <boolean name="flip_invalid_normals" value="false"/>
    <boolean name="use_shadowing_function" value="false"/>
    <bsdf type="conductor"/>
</bsdf>)"}});

}  // namespace
}  // namespace aureole
